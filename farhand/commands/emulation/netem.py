"""`farhand netem`: the emulator as a program, and its check. Live control: netem_live.py."""

import json
from typing import Annotated

import typer

from farhand.commands.emulation.netem_live import register_live_commands
from farhand.commands.options import InsecureOption, TlsOption
from farhand.netem.endpoints import DEFAULT_ENDPOINT

netem_app = typer.Typer(
    help="Emulate a network between the operator's and the robot's side.", invoke_without_command=True
)

register_live_commands(netem_app)


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
        str,
        typer.Option(
            help="Endpoint that the operator's side connects to "
            "(default: port 7447 of this host; none with --connect-operator)."
        ),
    ] = "",
    listen_robot: Annotated[
        str,
        typer.Option(
            help="Endpoint that the robot's side connects to "
            "(default: port 7448 of this host; none with --connect-robot)."
        ),
    ] = "",
    connect_operator: Annotated[
        list[str] | None,
        typer.Option(help="Endpoint on the operator's side to connect to, such as a Zenoh router's."),
    ] = None,
    connect_robot: Annotated[
        list[str] | None,
        typer.Option(help="Endpoint on the robot's side to connect to, such as a Zenoh router's."),
    ] = None,
    router: Annotated[
        bool,
        typer.Option(
            "--router",
            help="Be a client of what is connected to: a router whose neighbours are peers, as in ROS 2.",
        ),
    ] = False,
    stats: Annotated[str, typer.Option(help="Write the statistics to this JSON file at the end.")] = "",
    log: Annotated[str, typer.Option(help="Write the fate of every message to this CSV file.")] = "",
    timeline: Annotated[str, typer.Option(help="TOML file of changes at given times.")] = "",
    control: Annotated[
        str,
        typer.Option(help=f"Listen for live control on this local port or endpoint ({DEFAULT_ENDPOINT})."),
    ] = "",
    metrics: Annotated[
        int, typer.Option(help="Serve Prometheus metrics on this local port (default: none).")
    ] = 0,
    ready_file: Annotated[str, typer.Option(help="Write this file once both sides listen.")] = "",
    ready_fd: Annotated[
        int, typer.Option(help="Write a line to this file descriptor once both listen (default: none).")
    ] = -1,
    backend: Annotated[
        str,
        typer.Option(
            metavar="message | tc", help="Who emulates: this program, on messages, or the kernel, on packets."
        ),
    ] = "message",
    tc_operator: Annotated[
        str, typer.Option(help="Network device of the operator's side (default: the endpoint's).")
    ] = "",
    tc_robot: Annotated[str, typer.Option(help="Network device of the robot's side.")] = "",
    tls: TlsOption = "",
    insecure: InsecureOption = False,
    robot_network: Annotated[
        list[str] | None,
        typer.Option(
            help="A network of one robot's own: NAME=SPEC, NAME:uplink=SPEC or NAME:downlink=SPEC, "
            "e.g. arm2=constant:100; repeatable."
        ),
    ] = None,
) -> None:
    """Run the emulator; without a sub-command. Ctrl-C ends it and prints what it did."""
    if context.invoked_subcommand is not None:
        return
    from farhand.commands.emulation.netem_options import own_networks
    from farhand.common.process.security import local_endpoint
    from farhand.netem.settings import NetemSettings
    from farhand.programs.netem import netem_program

    if not listen_operator and not connect_operator:
        listen_operator = local_endpoint(7447, tls)
    if not listen_robot and not connect_robot:
        listen_robot = local_endpoint(7448, tls)
    settings = NetemSettings(
        certificates=tls,
        robot_networks=own_networks(robot_network or ()),
        listen_operator=listen_operator,
        listen_robot=listen_robot,
        connect_operator=tuple(connect_operator or ()),
        connect_robot=tuple(connect_robot or ()),
        router=router,
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
    netem_program(settings, insecure=insecure, backend=backend, tc_operator=tc_operator, tc_robot=tc_robot)


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
    from farhand.common.process.console import page, whole
    from farhand.netem.check.check import CheckSettings, run_check
    from farhand.netem.check.check_table import check_table

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
        console = page()
        console.print(whole(check_table(found), console))
    if not found["passed"]:
        raise typer.Exit(1)
