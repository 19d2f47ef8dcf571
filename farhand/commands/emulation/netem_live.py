"""Commands that look at a running emulator or change it: show, set, add, remove, outage, reset, common."""

import json
from typing import Annotated, Any

import typer

from farhand.netem.endpoints import DEFAULT_ENDPOINT

ControlOption = Annotated[
    str,
    typer.Option("--control", help="Where the running emulator's live control listens: a port or endpoint."),
]
DirectionOption = Annotated[
    str, typer.Option("--direction", metavar="uplink | downlink | both", help="Which way.")
]
OwnOption = Annotated[
    str,
    typer.Option(
        "--robot",
        help="Only this robot's own network; without one of its own it gets a copy of the common one.",
    ),
]


def register_live_commands(app: typer.Typer) -> None:
    """Mount these commands."""
    for command in (show, add, remove, outage, reset, common):
        app.command()(command)
    app.command("set")(set_network)


def show(
    control: ControlOption = DEFAULT_ENDPOINT,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of a table.")] = False,
) -> None:
    """Show what a running emulator does: its network and its statistics."""
    import msgspec

    from farhand.common.process.console import page
    from farhand.netem.control import ask
    from farhand.netem.measure.report import print_statistics
    from farhand.netem.measure.result import NetemResult

    statistics = ask(control, {"do": "show"})["statistics"]
    if as_json:
        print(json.dumps(statistics))
    else:
        print_statistics(msgspec.convert(statistics, NetemResult), page())


def set_network(
    network: Annotated[str, typer.Argument(help='The new network, e.g. "constant:100 loss:2%".')],
    direction: DirectionOption = "both",
    robot: OwnOption = "",
    control: ControlOption = DEFAULT_ENDPOINT,
) -> None:
    """Replace the whole network of a running emulator: the common one, or one robot's own."""
    _change(control, {"do": "set", "direction": direction, "spec": network}, robot)


def add(
    words: Annotated[str, typer.Argument(help='Impairments to add or replace, e.g. "loss:2% rate:1mbit".')],
    direction: DirectionOption = "both",
    robot: OwnOption = "",
    control: ControlOption = DEFAULT_ENDPOINT,
) -> None:
    """Add impairments; one of the same kind is replaced, the others keep their state."""
    _change(control, {"do": "add", "direction": direction, "spec": words}, robot)


def remove(
    name: Annotated[
        str, typer.Argument(help="A kind (delay, loss, rate, outage, ...) or a class (camera, ...).")
    ],
    direction: DirectionOption = "both",
    robot: OwnOption = "",
    control: ControlOption = DEFAULT_ENDPOINT,
) -> None:
    """Remove an impairment, or what is special to a class of messages, from the directions that have it."""
    _change(control, {"do": "remove", "direction": direction, "name": name}, robot)


def outage(
    seconds: Annotated[float, typer.Argument(help="How long there is no network (s).")],
    hold: Annotated[bool, typer.Option(help="Keep the messages and release them in one burst.")] = False,
    direction: DirectionOption = "both",
    robot: OwnOption = "",
    control: ControlOption = DEFAULT_ENDPOINT,
) -> None:
    """Cut the network now, for a time: everybody's, or one robot's."""
    _change(control, {"do": "outage", "direction": direction, "length": seconds, "hold": hold}, robot)


def reset(
    direction: DirectionOption = "both",
    robot: OwnOption = "",
    control: ControlOption = DEFAULT_ENDPOINT,
) -> None:
    """Go back to the network of the start: everybody, or one robot."""
    _change(control, {"do": "reset", "direction": direction}, robot)


def common(
    robot: Annotated[str, typer.Argument(help="The robot that has a network of its own.")],
    direction: DirectionOption = "both",
    control: ControlOption = DEFAULT_ENDPOINT,
) -> None:
    """Let a robot share the common network again."""
    _change(control, {"do": "common", "direction": direction}, robot)


def _change(control: str, request: dict[str, object], robot: str) -> None:
    """Ask for a change and print the networks after it."""
    from farhand.common.messages.keys import check_robot_name
    from farhand.netem.control import ask

    if robot:
        request["robot"] = check_robot_name(robot)
    found: dict[str, Any] = ask(control, request)
    for direction, spec in found["specs"].items():
        print(f"{direction}: {spec}")
    for direction, own in found["robot_specs"].items():
        for name, spec in own.items():
            print(f"{direction} of {name}: {spec}")
    if robot and robot not in found["seen"]:
        seen = ", ".join(name for name in found["seen"] if name not in ("other", "netem")) or "none"
        print(f"note: nothing of a robot {robot!r} has passed yet; robots seen: {seen}")
