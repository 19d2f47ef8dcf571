"""Commands that are one program of a system that runs. Heavy modules are imported only where they are used."""

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


def handover(
    to: Annotated[
        str, typer.Option(help="Name of who shall get control (default: the only one who waits).")
    ] = "",
    connect: Annotated[
        str, typer.Option(help="The --report endpoint of this host's operator, which holds control.")
    ] = "tcp/127.0.0.1:7446",
    robot: RobotOption = "ur5",
) -> None:
    """Hand control of a robot over to another operator who waits for it."""
    from farhand.common.process.security import local_only
    from farhand.site.handover import hand_over

    raise typer.Exit(hand_over(local_only(connect, "--connect"), robot, to))


def estop(
    robot: RobotOption = "ur5",
    connect: Annotated[
        list[str] | None,
        typer.Option(
            help="Endpoint of the robot, the emulator, or an operator's --report (default: all of this host)."
        ),
    ] = None,
    tls: TlsOption = "",
    router: RouterOption = False,
) -> None:
    """Emergency stop, whoever holds control. The robot latches it until it is acknowledged.

    Exit code 0: the robot says that it stopped. 1: nobody confirmed it. 2: bad input.
    """
    from farhand.site.estop import emergency_stop

    raise typer.Exit(emergency_stop(robot, connect or [], tls, router))


def acknowledge(
    robot: RobotOption = "ur5",
    connect: Annotated[
        list[str] | None,
        typer.Option(
            help="Endpoint of an operator's --report, the robot, or the emulator (default: all of this host)."
        ),
    ] = None,
    tls: TlsOption = "",
    router: RouterOption = False,
) -> None:
    """Clear a robot's latched stop, and no more: the operator in control acknowledges it, and drives as before.

    Exit code 0: the robot left its stop. 1: it did not, and why is said. 2: bad input.
    """
    from farhand.site.acknowledge import acknowledge as clear

    raise typer.Exit(clear(robot, connect or [], tls, router))


def robots(
    connect: ConnectOption = None,
    tls: TlsOption = "",
    router: RouterOption = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of a table.")] = False,
) -> None:
    """List who is there: robots, their operators and emulators, and who holds control."""
    from farhand.common.process.security import local_endpoint
    from farhand.site.robots import list_robots

    raise typer.Exit(list_robots(connect or [local_endpoint(7447, tls)], tls, as_json, router))


def doctor(
    connect: Annotated[str, typer.Option(help="Where the operator connects to.")] = "",
    robot: RobotOption = "ur5",
    tls: TlsOption = "",
    router: RouterOption = False,
    scenario: ScenarioOption = "ur5-obstacle",
    count: Annotated[int, typer.Option(min=1, max=10_000, help="Questions that measure the path.")] = 60,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of a table.")] = False,
) -> None:
    """Check the path to a robot: reachability, TLS, round trip, loss, versions, rights, certificates.

    Exit code 0: nothing is in the way. 1: something is, and what to do about it is said. 2: bad input.
    """
    from farhand.common.messages.keys import check_robot_name
    from farhand.common.process.security import local_endpoint
    from farhand.runs.scenario import load_scenario
    from farhand.site.doctor.doctor import run_doctor

    endpoint = connect or local_endpoint(7447, tls)
    asked = load_scenario(scenario)
    found = run_doctor(endpoint, check_robot_name(robot), tls, asked, count, as_json, router)
    raise typer.Exit(found)


def watch(
    connect: Annotated[str, typer.Option(help="The operator's --report endpoint.")] = "tcp/127.0.0.1:7446",
    robot: RobotOption = "ur5",
) -> None:
    """Live status of a running operator, in a program of its own so that it cannot disturb control."""
    from farhand.demo.live_status import watch_operator

    raise typer.Exit(watch_operator(connect, robot))


def record(
    connect: Annotated[str, typer.Option(help="The operator's --report endpoint.")] = "tcp/127.0.0.1:7446",
    robot: RobotOption = "ur5",
    netem: Annotated[
        str,
        typer.Option(
            help="The emulator's --control endpoint: what became of every message, to have it again."
        ),
    ] = "",
    frames: Annotated[
        float | None,
        typer.Option(
            min=0.0,
            max=60.0,
            help="Pictures of a camera that are recorded, 1/s; 0: none (default: 5, fewer where they are large).",
        ),
    ] = None,
    out: Annotated[Path | None, typer.Option(help="File to write (default: runs/TIME-ROBOT.mcap).")] = None,
) -> None:
    """Record a running operator: what arrived, what it decided and why, as an MCAP file that opens in Foxglove.

    A program of its own, so that no disk disturbs control. It ends with the operator's program, or on Ctrl-C. What was
    before it came is there as well, some minutes back. Exit code 1: something is missing, and is said.
    """
    from farhand.programs.recorder import RecorderOptions, recorder_program

    options = RecorderOptions(robot=robot, connect=connect, netem=netem, frames=frames, out=out)
    raise typer.Exit(recorder_program(options))


def foxglove(
    run: Annotated[
        Path | None, typer.Argument(help="A recording, or its folder (default: a running operator).")
    ] = None,
    connect: Annotated[str, typer.Option(help="The operator's --report endpoint.")] = "tcp/127.0.0.1:7446",
    robot: RobotOption = "ur5",
    netem: Annotated[
        str, typer.Option(help="The emulator's --control endpoint: what became of every message.")
    ] = "",
    listen: Annotated[
        str, typer.Option(metavar="HOST:PORT", help="Where Foxglove finds it; port 0: any that is free.")
    ] = "127.0.0.1:8765",
) -> None:
    """Show a run in Foxglove: a running operator, or a recording with Foxglove's own play, pause and seek.

    It shows, and moves nothing. It ends on Ctrl-C.
    """
    from farhand.programs.foxglove import FoxgloveOptions, foxglove_program

    options = FoxgloveOptions(run=run, connect=connect, robot=robot, netem=netem, listen=listen)
    raise typer.Exit(foxglove_program(options))


def console(
    connect: Annotated[str, typer.Option(help="The operator's --report endpoint.")] = "tcp/127.0.0.1:7446",
    listen: Annotated[
        str,
        typer.Option(
            metavar="HOST:PORT", help="Where browsers find it; beyond this host with --token and --tls."
        ),
    ] = "127.0.0.1:8080",
    robot: RobotOption = "ur5",
    token: Annotated[str, typer.Option(help="A word that a page must know to be let in.")] = "",
    tls: TlsOption = "",
    netem: Annotated[
        str,
        typer.Option(
            metavar="ENDPOINT",
            help="The emulator's --control on this host: who drives may change the network.",
        ),
    ] = "",
    open_browser: Annotated[bool, typer.Option("--open", help="Open a browser here.")] = False,
) -> None:
    """The operator's seat in a browser: drive a robot by hand, beside a running `farhand operator --steer remote`."""
    from farhand.programs.console import ConsoleOptions, console_program

    options = ConsoleOptions(
        robot=robot, connect=connect, listen=listen, token=token, tls=tls, netem=netem, opens=open_browser
    )
    raise typer.Exit(console_program(options))


def steer(
    device: Annotated[
        str, typer.Argument(metavar="gamepad | spacemouse | recorded:RUN", help="What steers.")
    ],
    connect: Annotated[str, typer.Option(help="The operator's --report endpoint.")] = "tcp/127.0.0.1:7446",
    robot: RobotOption = "ur5",
    scenario: ScenarioOption = "ur5-obstacle",
    settings: SetOption = None,
    realtime: RealtimeOption = True,
) -> None:
    """Drive with a device of this host, beside a running `farhand operator --steer remote` (or of the same device).

    What its axes and buttons do is in [steering.gamepad] of the scenario, and in --set steering.gamepad.x=...
    """
    from farhand.programs.steer import SteerOptions, steer_program

    chosen = chosen_scenario(scenario, settings, steer=device)
    raise typer.Exit(steer_program(chosen, SteerOptions(robot=robot, connect=connect, realtime=realtime)))


def devices(
    watch: Annotated[bool, typer.Option("--watch", help="Show what they show, until Ctrl-C.")] = False,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print JSON; with --watch, a line for each change.")
    ] = False,
) -> None:
    """List the gamepads and SpaceMouses of this host, and the names of their axes and buttons.

    Exit code 0: there are some. 1: there is none, and what to do is said.
    """
    from farhand.site.devices import list_devices

    raise typer.Exit(list_devices(watch=watch, as_json=as_json))


def tap(
    endpoint: Annotated[str, typer.Argument(help="Endpoint to connect to, such as tcp/127.0.0.1:7447.")],
    key: Annotated[str, typer.Option(help="Key expression to listen to.")] = "**",
    count: Annotated[int | None, typer.Option(min=1, help="End after this many messages.")] = None,
    router: RouterOption = False,
    tls: TlsOption = "",
) -> None:
    """Print whatever travels: any MessagePack, decoded without knowledge of Farhand's messages."""
    from farhand.site.tap import run_tap

    raise typer.Exit(run_tap(endpoint, key, count, router, tls))


def register(app: typer.Typer) -> None:
    """Mount these commands."""
    for command in (
        operator,
        robot,
        camera,
        handover,
        estop,
        acknowledge,
        robots,
        doctor,
        watch,
        record,
        foxglove,
        console,
        steer,
        devices,
        tap,
    ):
        app.command()(command)
