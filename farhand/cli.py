"""The command line: every command with its help. Heavy modules are imported only by the commands that use them."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from common.errors import FarhandError, InputError
from farhand.certs_commands import certs_app
from farhand.experiment_commands import register as register_experiments
from farhand.netem_commands import netem_app
from farhand.options import (
    ConnectOption,
    DownlinkOption,
    InsecureOption,
    JsonOption,
    ListenOption,
    MarginOption,
    NetworkOption,
    PredictorOption,
    RealtimeOption,
    RobotOption,
    RouterOption,
    ScenarioOption,
    SeedOption,
    SetOption,
    SolverOption,
    TimeLimitOption,
    TimelineOption,
    TlsOption,
    UplinkOption,
    chosen_scenario,
    split_network,
)
from farhand.process import die_with_parent
from farhand.trace_commands import trace_app

app = typer.Typer(
    name="farhand",
    help="Move a robot that is far away, over a bad network, without it hitting anything.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)

# Typer carries a Click of its own and exports only some of its exceptions; all of them share this base.
UsageError: type[Exception] = next(c for c in typer.BadParameter.__mro__ if c.__name__ == "ClickException")

OutOption = Annotated[
    Path | None, typer.Option("--out", help="Folder for the results [default: runs/<time>-<scenario>].")
]


@app.command()
def demo(
    scenario: ScenarioOption = "ur5-obstacle",
    network: NetworkOption = "5g-urban",
    uplink: UplinkOption = "",
    downlink: DownlinkOption = "",
    margin: MarginOption = None,
    predictor: PredictorOption = None,
    solver: SolverOption = None,
    settings: SetOption = None,
    seed: SeedOption = 0,
    time_limit: TimeLimitOption = 90.0,
    timeline: TimelineOption = None,
    out: OutOption = None,
    as_json: JsonOption = False,
) -> None:
    """Drive a robot past an obstacle over an emulated network: three programs, one live status, one summary.

    Exit code 0: safe and finished. 1: not safe, or not finished. 2: bad input.
    """
    from farhand.demo import run_demo

    chosen = chosen_scenario(scenario, margin, predictor, solver, settings)
    up, down = split_network(network, uplink, downlink)
    code = run_demo(
        chosen,
        uplink=up,
        downlink=down,
        seed=seed,
        time_limit=time_limit,
        timeline=timeline,
        out=out,
        as_json=as_json,
    )
    raise typer.Exit(code)


@app.command()
def simulate(
    scenario: ScenarioOption = "ur5-obstacle",
    network: NetworkOption = "5g-urban",
    uplink: UplinkOption = "",
    downlink: DownlinkOption = "",
    margin: MarginOption = None,
    predictor: PredictorOption = None,
    solver: SolverOption = None,
    settings: SetOption = None,
    seed: SeedOption = 0,
    time_limit: TimeLimitOption = 90.0,
    computing_time: Annotated[
        float, typer.Option(min=0.0, max=1000.0, help="Modelled computing time of a control tick, ms.")
    ] = 20.0,
    timeline: TimelineOption = None,
    out: OutOption = None,
    as_json: JsonOption = False,
) -> None:
    """Run one task in virtual time: the same nodes, summary and figure as the demo, in a fraction of the time."""
    from farhand.simulate_command import run_simulation

    chosen = chosen_scenario(scenario, margin, predictor, solver, settings)
    up, down = split_network(network, uplink, downlink)
    code = run_simulation(
        chosen,
        uplink=up,
        downlink=down,
        seed=seed,
        time_limit=time_limit,
        computing_time=computing_time / 1000.0,
        timeline=timeline,
        out=out,
        as_json=as_json,
    )
    raise typer.Exit(code)


@app.command()
def operator(
    scenario: ScenarioOption = "ur5-obstacle",
    connect: ConnectOption = None,
    listen: ListenOption = None,
    robot: RobotOption = "ur5",
    margin: MarginOption = None,
    predictor: PredictorOption = None,
    solver: SolverOption = None,
    settings: SetOption = None,
    report: Annotated[
        str, typer.Option(help="Publish a report of every tick on this local endpoint, for `farhand watch`.")
    ] = "",
    seed: SeedOption = 0,
    time_limit: Annotated[
        float | None, typer.Option(min=0.1, max=1e6, help="Give up this long after the first motion, s.")
    ] = None,
    record: Annotated[
        Path | None, typer.Option(help="Record what arrives and what is decided, for `farhand replay`.")
    ] = None,
    result: Annotated[Path | None, typer.Option(help="Write the results to this JSON file.")] = None,
    realtime: RealtimeOption = True,
    tls: TlsOption = "",
    insecure: InsecureOption = False,
    router: RouterOption = False,
) -> None:
    """The operator's side: steering device, state predictor, safety margin, MPC with barrier functions.

    Ends by itself when the task is finished.
    """
    from farhand.programs import check_writable, operator_program
    from farhand.security import local_endpoint

    chosen = chosen_scenario(scenario, margin, predictor, solver, settings)
    check_writable(record, "--record")
    check_writable(result, "--result")
    endpoints = connect or ([] if listen else [local_endpoint(7447, tls)])
    code = operator_program(
        chosen,
        name=robot,
        connect=endpoints,
        listen=listen or [],
        report=report or None,
        seed=seed,
        time_limit=time_limit,
        record=record,
        result=result,
        realtime=realtime,
        tls=tls,
        insecure=insecure,
        router=router,
    )
    raise typer.Exit(code)


@app.command()
def robot(
    scenario: ScenarioOption = "ur5-obstacle",
    connect: ConnectOption = None,
    listen: ListenOption = None,
    name: Annotated[str, typer.Option("--robot", help="Name of the robot, part of its keys.")] = "ur5",
    settings: SetOption = None,
    result: Annotated[Path | None, typer.Option(help="Write the results to this JSON file.")] = None,
    realtime: RealtimeOption = True,
    tls: TlsOption = "",
    insecure: InsecureOption = False,
    router: RouterOption = False,
) -> None:
    """The robot's side: watchdog, velocity control, robot. Runs until it is told to end (Ctrl-C)."""
    from farhand.programs import check_writable, robot_program
    from farhand.security import local_endpoint

    chosen = chosen_scenario(scenario, None, None, None, settings)
    check_writable(result, "--result")
    endpoints = connect or ([] if listen else [local_endpoint(7448, tls)])
    raise typer.Exit(
        robot_program(
            chosen,
            name=name,
            connect=endpoints,
            listen=listen or [],
            result=result,
            realtime=realtime,
            tls=tls,
            insecure=insecure,
            router=router,
        )
    )


@app.command()
def summarise(
    folder: Annotated[Path, typer.Argument(help="Folder with operator.json, netem.json, robot.json.")],
    scenario: ScenarioOption = "ur5-obstacle",
    network: NetworkOption = "5g-urban",
    uplink: UplinkOption = "",
    downlink: DownlinkOption = "",
    margin: MarginOption = None,
    predictor: PredictorOption = None,
    solver: SolverOption = None,
    settings: SetOption = None,
    seed: SeedOption = 0,
    why: Annotated[str, typer.Option(help="What went wrong, where the files cannot say it.")] = "",
    as_json: JsonOption = False,
) -> None:
    """Summary and figure of a run whose programs ran on hosts of their own; options as in that run.

    Exit code 0: safe and finished. 1: not safe, or not finished. 2: bad input.
    """
    from farhand.summarise_command import run_summarise

    chosen = chosen_scenario(scenario, margin, predictor, solver, settings)
    up, down = split_network(network, uplink, downlink)
    code = run_summarise(folder, chosen, uplink=up, downlink=down, seed=seed, why=why, as_json=as_json)
    raise typer.Exit(code)


@app.command()
def robots(
    connect: ConnectOption = None,
    tls: TlsOption = "",
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of a table.")] = False,
) -> None:
    """List who is there: robots, their operators and emulators, and who holds control."""
    from farhand.robots import list_robots
    from farhand.security import local_endpoint

    raise typer.Exit(list_robots(connect or [local_endpoint(7447, tls)], tls, as_json))


@app.command()
def doctor(
    connect: Annotated[str, typer.Option(help="Where the operator connects to.")] = "",
    robot: RobotOption = "ur5",
    tls: TlsOption = "",
    scenario: ScenarioOption = "ur5-obstacle",
    count: Annotated[int, typer.Option(min=1, max=10_000, help="Questions that measure the path.")] = 60,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of a table.")] = False,
) -> None:
    """Check the path to a robot: reachability, TLS, round trip, loss, versions, rights, certificates.

    Exit code 0: nothing is in the way. 1: something is, and what to do about it is said. 2: bad input.
    """
    from common.keys import check_robot_name
    from common.scenario import load_scenario
    from farhand.doctor import run_doctor
    from farhand.security import local_endpoint

    endpoint = connect or local_endpoint(7447, tls)
    found = run_doctor(endpoint, check_robot_name(robot), tls, load_scenario(scenario), count, as_json)
    raise typer.Exit(found)


@app.command()
def watch(
    connect: Annotated[str, typer.Option(help="The operator's --report endpoint.")] = "tcp/127.0.0.1:7446",
    robot: RobotOption = "ur5",
) -> None:
    """Live status of a running operator, in a program of its own so that it cannot disturb control."""
    from farhand.live_status import watch_operator

    raise typer.Exit(watch_operator(connect, robot))


@app.command()
def tap(
    endpoint: Annotated[str, typer.Argument(help="Endpoint to connect to, such as tcp/127.0.0.1:7447.")],
    key: Annotated[str, typer.Option(help="Key expression to listen to.")] = "**",
    count: Annotated[int | None, typer.Option(min=1, help="End after this many messages.")] = None,
) -> None:
    """Print whatever travels: any MessagePack, decoded without knowledge of Farhand's messages."""
    from farhand.tap import run_tap

    raise typer.Exit(run_tap(endpoint, key, count))


@app.command()
def scenarios() -> None:
    """What scenarios are built in."""
    from common.scenario import built_in_names, load_scenario
    from farhand.options import print_rows

    print_rows([(name, load_scenario(name).description) for name in built_in_names()])


@app.command()
def networks() -> None:
    """What networks are built in, and how to write one."""
    from farhand.options import print_rows
    from netem.profiles import describe_profiles

    rows = [
        ("none", "nothing is delayed"),
        ("constant:200", "200 ms each way"),
        ("uniform:50,200", "50 to 200 ms each way"),
        ("gaussian:50,20", "mean 50 ms, standard deviation 20 ms, each way"),
        ("trace:FILE", "replays a recorded delay trace"),
    ]
    print_rows([*rows, *describe_profiles()])


app.add_typer(netem_app, name="netem")
app.add_typer(trace_app, name="trace")
app.add_typer(certs_app, name="certs")
register_experiments(app)


def run(arguments: list[str] | None = None) -> int:
    """Run the command line; returns the exit code."""
    die_with_parent()
    try:
        result = app(arguments, prog_name="farhand", standalone_mode=False)
    except typer.Exit as end:
        return int(end.exit_code)
    except typer.Abort:
        return 130
    except UsageError as error:
        if type(error).__name__ == "NoArgsIsHelpError":
            error.show()  # type: ignore[attr-defined]
            return 2
        return _refuse(_usage(error))
    except InputError as error:
        return _refuse(f"farhand: {error}")
    except FarhandError as error:
        print(f"farhand: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130
    return result if isinstance(result, int) else 0


def _usage(error: Exception) -> str:
    """One line for an error in the use of a command: where, what, and where to read on."""
    text = getattr(error, "format_message", lambda: str(error))()
    context = getattr(error, "ctx", None)
    command = getattr(context, "command_path", "farhand")
    return f"{command}: {text} (see `{command} --help`)"


def _refuse(line: str) -> int:
    print(" ".join(line.split()), file=sys.stderr)
    return 2
