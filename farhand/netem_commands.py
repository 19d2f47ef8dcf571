"""`farhand netem`: the emulator as a program, its live control, and its check."""

import json
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from common.errors import InputError
from common.keys import check_robot_name
from common.zenoh_log import tell_refusals
from farhand.options import InsecureOption, TlsOption
from farhand.security import local_endpoint, secure
from netem.check import CheckSettings, run_check
from netem.control import DEFAULT_ENDPOINT, ask
from netem.main import NetemSettings, run_netem, say, stop_on_signals
from netem.report import milliseconds, statistics_table
from netem.spec import parse_spec

netem_app = typer.Typer(
    help="Emulate a network between the operator's and the robot's side.", invoke_without_command=True
)

ControlOption = Annotated[
    str,
    typer.Option("--control", help="Where the running emulator's live control listens: a port or endpoint."),
]
DirectionOption = Annotated[str, typer.Option("--direction", help="uplink, downlink or both.")]


@netem_app.callback()
def netem(
    context: typer.Context,
    network: Annotated[
        str, typer.Option(help='What both directions are like, e.g. "gaussian:50,20 loss:1%", or a profile.')
    ] = "none",
    uplink: Annotated[str, typer.Option(help="Operator to robot, where it differs from --network.")] = "",
    downlink: Annotated[str, typer.Option(help="Robot to operator, where it differs.")] = "",
    seed: Annotated[int, typer.Option(help="Seed of all draws.")] = 0,
    listen_operator: Annotated[
        str, typer.Option(help="Endpoint that the operator's side connects to.")
    ] = "tcp/127.0.0.1:7447",
    listen_robot: Annotated[
        str, typer.Option(help="Endpoint that the robot's side connects to.")
    ] = "tcp/127.0.0.1:7448",
    connect_operator: Annotated[
        list[str] | None,
        typer.Option(help="Endpoint on the operator's side to connect to, such as a router."),
    ] = None,
    connect_robot: Annotated[
        list[str] | None, typer.Option(help="Endpoint on the robot's side to connect to.")
    ] = None,
    stats: Annotated[str, typer.Option(help="Write the statistics to this JSON file at the end.")] = "",
    log: Annotated[str, typer.Option(help="Write the fate of every message to this CSV file.")] = "",
    timeline: Annotated[str, typer.Option(help="TOML file of changes at given times.")] = "",
    control: Annotated[
        str,
        typer.Option(help=f"Listen for live control on this local port or endpoint ({DEFAULT_ENDPOINT})."),
    ] = "",
    metrics: Annotated[int, typer.Option(help="Serve Prometheus metrics on this local port.")] = 0,
    ready_file: Annotated[str, typer.Option(help="Write this file once both sides listen.")] = "",
    ready_fd: Annotated[
        int, typer.Option(help="Write a line to this file descriptor once both listen.")
    ] = -1,
    backend: Annotated[
        str, typer.Option(help="Who emulates: message (this program) or tc (the kernel, on packets).")
    ] = "message",
    tc_operator: Annotated[
        str, typer.Option(help="Network device of the operator's side [default: the endpoint's].")
    ] = "",
    tc_robot: Annotated[str, typer.Option(help="Network device of the robot's side.")] = "",
    tls: TlsOption = "",
    insecure: InsecureOption = False,
    robot_network: Annotated[
        list[str] | None,
        typer.Option(help="NAME=SPEC: a network of one robot's own, e.g. arm2=constant:100; repeatable."),
    ] = None,
) -> None:
    """Run the emulator; without a sub-command. Ctrl-C ends it and prints what it did."""
    if context.invoked_subcommand is not None:
        return
    if tls:  # the defaults as TLS needs them
        if listen_operator == "tcp/127.0.0.1:7447":
            listen_operator = local_endpoint(7447, tls)
        if listen_robot == "tcp/127.0.0.1:7448":
            listen_robot = local_endpoint(7448, tls)
    ends = [*(connect_operator or ()), *(connect_robot or ())]
    secure(tls, insecure, ends, [listen_operator, listen_robot], say, "netem")
    if tls:
        tell_refusals(say)
    settings = NetemSettings(
        certificates=tls,
        robot_networks=tuple(_own_network(text) for text in robot_network or ()),
        listen_operator=listen_operator,
        listen_robot=listen_robot,
        connect_operator=tuple(connect_operator or ()),
        connect_robot=tuple(connect_robot or ()),
        uplink=uplink or network,
        downlink=downlink or network,
        seed=seed,
        stats=stats or None,
        log=log or None,
        timeline=timeline or None,
        control=control or None,
        metrics=metrics,
        ready_file=ready_file or None,
        ready_fd=ready_fd if ready_fd >= 0 else None,
    )
    if backend == "tc":
        from netem.backend_tc import kernel_emulation

        stop_event = stop_on_signals()
        with kernel_emulation(settings, tc_operator, tc_robot) as forwarding:
            run_netem(forwarding, stop_event, Console())
        return
    if backend != "message":
        raise InputError(f"--backend {backend!r}: must be message or tc")
    if tc_operator or tc_robot:
        raise InputError("--tc-operator and --tc-robot: only with --backend tc")
    run_netem(settings, stop_on_signals(), Console())


@netem_app.command()
def show(
    control: ControlOption = DEFAULT_ENDPOINT,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of a table.")] = False,
) -> None:
    """Show what a running emulator does: its network and its statistics."""
    statistics = ask(control, {"do": "show"})["statistics"]
    if as_json:
        print(json.dumps(statistics))
    else:
        Console().print(statistics_table(statistics))


@netem_app.command("set")
def set_network(
    network: Annotated[str, typer.Argument(help='The new network, e.g. "constant:100 loss:2%".')],
    direction: DirectionOption = "both",
    control: ControlOption = DEFAULT_ENDPOINT,
) -> None:
    """Replace the whole network of a running emulator."""
    _change(control, {"do": "set", "direction": direction, "spec": network})


@netem_app.command()
def add(
    words: Annotated[str, typer.Argument(help='Impairments to add or replace, e.g. "loss:2% rate:1mbit".')],
    direction: DirectionOption = "both",
    control: ControlOption = DEFAULT_ENDPOINT,
) -> None:
    """Add impairments; one of the same kind is replaced, the others keep their state."""
    _change(control, {"do": "add", "direction": direction, "spec": words})


@netem_app.command()
def remove(
    name: Annotated[
        str, typer.Argument(help="A kind (delay, loss, rate, outage, ...) or a class (camera, ...).")
    ],
    direction: DirectionOption = "both",
    control: ControlOption = DEFAULT_ENDPOINT,
) -> None:
    """Remove an impairment, or what is special to a class of messages."""
    _change(control, {"do": "remove", "direction": direction, "name": name})


@netem_app.command()
def outage(
    seconds: Annotated[float, typer.Argument(help="How long there is no network (s).")],
    hold: Annotated[bool, typer.Option(help="Keep the messages and release them in one burst.")] = False,
    direction: DirectionOption = "both",
    control: ControlOption = DEFAULT_ENDPOINT,
) -> None:
    """Cut the network now, for a time."""
    _change(control, {"do": "outage", "direction": direction, "length": seconds, "hold": hold})


@netem_app.command()
def reset(control: ControlOption = DEFAULT_ENDPOINT) -> None:
    """Go back to the network of the start."""
    _change(control, {"do": "reset"})


@netem_app.command()
def check(
    network: Annotated[str, typer.Option(help="What to check, both directions.")] = "gaussian:50,20",
    uplink: Annotated[str, typer.Option(help="Operator to robot, where it differs.")] = "",
    downlink: Annotated[str, typer.Option(help="Robot to operator, where it differs.")] = "",
    rate: Annotated[float, typer.Option(min=0.1, max=20_000, help="Messages a second, each way.")] = 500.0,
    seconds: Annotated[float, typer.Option(min=0.1, max=3600, help="How long.")] = 20.0,
    size: Annotated[int, typer.Option(min=8, max=1_000_000, help="Bytes a message.")] = 300,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the draws.")] = 1,
    realtime: Annotated[bool, typer.Option(help="Ask for SCHED_FIFO.")] = True,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of a table.")] = False,
) -> None:
    """Run the real proxy over loopback and compare what it did with what it drew."""
    found = run_check(
        CheckSettings(
            uplink=uplink or network,
            downlink=downlink or network,
            rate_hz=rate,
            seconds=seconds,
            size=size,
            seed=seed,
            realtime=realtime,
        )
    )
    if as_json:
        print(json.dumps(found))
    else:
        Console().print(_check_table(found))
    if not found["passed"]:
        raise typer.Exit(1)


def _own_network(text: str) -> tuple[str, str]:
    """Robot and SPEC of NAME=SPEC; raises InputError."""
    name, separator, spec = text.partition("=")
    if not separator:
        raise InputError(f"--robot-network {text!r}: expected NAME=SPEC such as arm2=constant:100")
    parse_spec(spec).prepare()
    return check_robot_name(name), spec


def _change(control: str, request: dict[str, object]) -> None:
    specs: dict[str, str] = ask(control, request)["specs"]
    for name, spec in specs.items():
        print(f"{name}: {spec}")


def _check_table(found: dict[str, Any]) -> Table:
    priority = "SCHED_FIFO" if found["realtime_priority"] else "plain scheduling"
    table = Table(
        title=f"netem check: {found['rate_hz']:g} messages/s of {found['size']} bytes each way for "
        f"{found['seconds']:g} s, seed {found['seed']}, {priority}",
        title_justify="left",
    )
    table.add_column("")
    both = [found["uplink"], found["downlink"]]
    for name in ("uplink", "downlink"):
        table.add_column(name, justify="right", overflow="fold")

    def row(label: str, *values: object) -> None:
        table.add_row(label, *(escape(str(value)) for value in values))

    def quantities(values: dict[str, float], *names: str) -> str:
        return " / ".join(milliseconds(values[name]) for name in names)

    row("network", *(d["spec"] for d in both))
    row("sent / taken in", *(f"{d['sent']} / {d['taken_in']}" for d in both))
    row("lost as drawn", *(", ".join(f"{c} {n}" for c, n in d["lost_as_drawn"].items()) or "0" for d in both))
    row("duplicated", *(d["duplicated"] for d in both))
    row("delivered / arrived", *(f"{d['delivered']} / {d['arrived']}" for d in both))
    row(
        "reordered as drawn / on arrival",
        *(f"{d['reordered_as_drawn']} / {d['reordered_on_arrival']}" for d in both),
    )
    table.add_section()
    for name in ("drawn", "assigned", "achieved"):
        row(f"{name}, mean / sd (ms)", *(quantities(d[name], "mean", "std") for d in both))
        row(f"{name}, p50 / p99 (ms)", *(quantities(d[name], "p50", "p99") for d in both))
    row("error, median / p99 / max (ms)", *(quantities(d["error"], "p50", "p99", "max") for d in both))
    row("Toxiproxy's own tests accept (ms)", "± 10", "± 10")
    table.add_section()
    row(
        "Kolmogorov-Smirnov against another seed",
        *(
            f"D = {d['ks']['statistic']:.4f}, p = {d['ks']['p']:.3f}" if "ks" in d else "too few"
            for d in both
        ),
    )
    row("same seed in virtual time: same fates, delays", *("yes" if d["replays"] else "NO" for d in both))
    row(
        "every message accounted for",
        *("yes" if d["accounted"] and found["conserved"] else "NO" for d in both),
    )
    return table
