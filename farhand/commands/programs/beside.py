"""Programs beside a running operator: they watch, record, show, steer. Heavy modules are imported only where needed."""

from pathlib import Path
from typing import Annotated

import typer

from farhand.commands.options import (
    RealtimeOption,
    RobotOption,
    ScenarioOption,
    SetOption,
    TlsOption,
    chosen_scenario,
)


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
    before it came is there as well: the newest 3000 ticks. Exit code 1: something is missing, and is said.
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
