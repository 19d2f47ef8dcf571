"""The three programs of a system that runs, and its camera. Heavy modules are imported only where they are used."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from farhand.commands.options import (
    ConnectOption,
    GuardOption,
    InsecureOption,
    ListenOption,
    MarginOption,
    PredictorOption,
    RateOption,
    RealtimeOption,
    RobotOption,
    RouterOption,
    ScenarioOption,
    SetOption,
    SolverOption,
    SteerOption,
    TlsOption,
    chosen_scenario,
    on_a_real_arm,
    settings_at,
)

if TYPE_CHECKING:
    from farhand.common.process.security import Access


def operator(
    scenario: ScenarioOption = "ur5-obstacle",
    connect: ConnectOption = None,
    listen: ListenOption = None,
    robot: RobotOption = "ur5",
    margin: MarginOption = None,
    predictor: PredictorOption = None,
    solver: SolverOption = None,
    steer: SteerOption = None,
    rate: RateOption = None,
    settings: SetOption = None,
    report: Annotated[
        str,
        typer.Option(
            help="Publish every tick on this local endpoint, for `farhand watch`, `console` and `record`."
        ),
    ] = "",
    seed: Annotated[int, typer.Option(min=0, help="Seed of the run, noted in its recording.")] = 0,
    time_limit: Annotated[
        float | None,
        typer.Option(
            min=0.1,
            max=1e6,
            help="Give up this long after the first motion (after the start, until there is one), s; waiting "
            "for control that another operator holds does not count.",
        ),
    ] = None,
    result: Annotated[Path | None, typer.Option(help="Write the results to this JSON file.")] = None,
    realtime: RealtimeOption = True,
    tls: TlsOption = "",
    insecure: InsecureOption = False,
    router: RouterOption = False,
    name: Annotated[
        str,
        typer.Option(
            help="What others call this operator (default: the certificate's name, else USER@HOST)."
        ),
    ] = "",
) -> None:
    """The operator's side: steering device, state predictor, safety margin, MPC with barrier functions.

    Ends by itself when the task is finished.
    """
    from farhand.common.process.outputs import check_writable
    from farhand.programs.operator import OperatorOptions, operator_program

    chosen = chosen_scenario(
        scenario, settings, rate=rate, margin=margin, predictor=predictor, solver=solver, steer=steer
    )
    check_writable(result, "--result")
    options = OperatorOptions(
        robot=robot,
        name=name,
        seed=seed,
        time_limit=time_limit,
        report=report,
        result=result,
        realtime=realtime,
    )
    raise typer.Exit(operator_program(chosen, _access(7447, connect, listen, tls, insecure, router), options))


def _access(
    port: int,
    connect: list[str] | None,
    listen: list[str] | None,
    tls: str,
    insecure: bool,
    router: bool,
) -> "Access":
    """What the options say of how a program meets the others; by default it connects to a port of this host."""
    from farhand.common.process.security import Access, local_endpoint

    endpoints = connect or ([] if listen else [local_endpoint(port, tls)])
    return Access(
        connect=tuple(endpoints), listen=tuple(listen or ()), tls=tls, insecure=insecure, router=router
    )


def robot(
    scenario: ScenarioOption = "ur5-obstacle",
    connect: ConnectOption = None,
    listen: ListenOption = None,
    name: Annotated[str, typer.Option("--robot", help="Name of the robot, part of its keys.")] = "ur5",
    host: Annotated[
        str | None,
        typer.Option(
            help="Controller of a real UR arm: drive that, in place of the scenario's UR (docs/ur.md)."
        ),
    ] = None,
    guard: GuardOption = None,
    settings: SetOption = None,
    result: Annotated[Path | None, typer.Option(help="Write the results to this JSON file.")] = None,
    realtime: RealtimeOption = True,
    tls: TlsOption = "",
    insecure: InsecureOption = False,
    router: RouterOption = False,
) -> None:
    """The robot's side: watchdog, guard, velocity control, robot. Runs until it is told to end (Ctrl-C)."""
    from farhand.common.process.outputs import check_writable
    from farhand.programs.robot import RobotOptions, robot_program

    chosen = chosen_scenario(scenario, settings_at(host, settings), guard=guard)
    if host is not None:
        chosen = on_a_real_arm(chosen, host)
    check_writable(result, "--result")
    options = RobotOptions(robot=name, result=result, realtime=realtime)
    raise typer.Exit(robot_program(chosen, _access(7448, connect, listen, tls, insecure, router), options))


def camera(
    camera: Annotated[
        str,
        typer.Option(
            metavar="pybullet | device:PATH",
            help="A view of the simulated robot, or a real camera such as device:/dev/video0.",
        ),
    ] = "pybullet",
    scenario: ScenarioOption = "ur5-obstacle",
    settings: SetOption = None,
    connect: ConnectOption = None,
    listen: ListenOption = None,
    robot: RobotOption = "ur5",
    size: Annotated[str, typer.Option(metavar="WIDTHxHEIGHT", help="Of a picture, in pixels.")] = "320x240",
    rate: Annotated[float, typer.Option(help="Pictures a second, 0.5 to 60.")] = 20.0,
    quality: Annotated[int, typer.Option(help="Of the JPEG, 10 to 95.")] = 80,
    tls: TlsOption = "",
    insecure: InsecureOption = False,
    router: RouterOption = False,
) -> None:
    """Pictures to the operator, from the robot's side: of the simulated robot, or from a real camera.

    It connects to the robot, whose states it draws, and to whatever leads to the operator (docs/camera.md).
    """
    from farhand.programs.camera import CameraOptions, camera_program
    from farhand.robot_side.camera.settings import check_camera, pictures

    wanted = pictures(size, rate, quality)
    options = CameraOptions(robot=robot, camera=check_camera(camera), pictures=wanted)
    chosen = chosen_scenario(scenario, settings)
    raise typer.Exit(camera_program(chosen, _access(7448, connect, listen, tls, insecure, router), options))
