"""Who is there, who holds control, what stands, what travels. Heavy modules are imported only where they are used."""

from typing import Annotated

import typer

from farhand.commands.options import (
    ConnectOption,
    RobotOption,
    RouterOption,
    ScenarioOption,
    TlsOption,
)


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
