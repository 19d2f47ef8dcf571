"""Options that several commands share, and what they mean."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from farhand.common.errors import InputError
from farhand.common.kinds import Kinds
from farhand.common.toml import parse_toml
from farhand.operator_side.control.registry import SOLVERS
from farhand.operator_side.margins.registry import MARGINS
from farhand.operator_side.prediction.registry import PREDICTORS
from farhand.operator_side.steering.registry import BY_HAND, DEVICES
from farhand.programs.command_line import DEFAULT_NETWORK

if TYPE_CHECKING:
    from farhand.runs.run import Network
    from farhand.runs.scenario import Scenario

ScenarioOption = Annotated[
    str, typer.Option(help="Built-in scenario (see `farhand scenarios`) or TOML file.")
]
NetworkOption = Annotated[
    str | None,
    typer.Option(
        help="SPEC of both directions, e.g. constant:200 (ms), or a name from `farhand networks` "
        f"(default: scenario's, else {DEFAULT_NETWORK})."
    ),
]
UplinkOption = Annotated[str | None, typer.Option(help="SPEC from operator to robot, where it differs.")]
DownlinkOption = Annotated[str | None, typer.Option(help="SPEC from robot to operator, where it differs.")]
MarginOption = Annotated[
    str | None, typer.Option(metavar=" | ".join(MARGINS.names()), help="Safety margin (default: scenario's).")
]
PredictorOption = Annotated[
    str | None,
    typer.Option(
        metavar=" | ".join(PREDICTORS.names()),
        help="State predictor (default: the one that the margin is made for).",
    ),
]
SolverOption = Annotated[
    str | None, typer.Option(metavar=" | ".join(SOLVERS.names()), help="Solver (default: scenario's).")
]
_STEERS = ["recorded:RUN" if name == "recorded" else name for name in DEVICES.names()]
STEERS = " | ".join(_STEERS)
SteerOption = Annotated[str | None, typer.Option(metavar=STEERS, help="What steers (default: scenario's).")]
SimulatedSteerOption = Annotated[
    str | None,
    typer.Option(
        metavar=" | ".join(name for name in _STEERS if name not in BY_HAND),
        help="What steers (default: scenario's).",
    ),
]
GuardOption = Annotated[
    str | None,
    typer.Option(
        metavar="on|off", help="The guard that keeps the whole robot clear (default: scenario's, on)."
    ),
]
RateOption = Annotated[
    float | None,
    typer.Option(
        min=1.0,
        max=500.0,
        help="Commands a second (default: 50 where a person steers, else the scenario's, 10).",
    ),
]
SetOption = Annotated[
    list[str] | None,
    typer.Option("--set", help="Replace a setting of the scenario, e.g. --set robot.lag=0.3."),
]
SeedOption = Annotated[int, typer.Option(min=0, help="Seed of everything that is drawn.")]
WorkersOption = Annotated[
    int, typer.Option(min=0, max=1024, help="Processes (default: one for each processor).")
]
TimeLimitOption = Annotated[
    float, typer.Option(min=0.1, max=1e6, help="Give up this long after the first motion, s.")
]
TimelineOption = Annotated[
    str | None, typer.Option(help="TOML file of changes of the network at given times (docs/netem.md).")
]
JsonOption = Annotated[bool, typer.Option("--json", help="Print the result as the last line, as JSON.")]
ConnectOption = Annotated[
    list[str] | None, typer.Option(help="Zenoh endpoint to connect to, e.g. tcp/10.0.0.2:7447; repeatable.")
]
ListenOption = Annotated[
    list[str] | None, typer.Option(help="Zenoh endpoint to listen on, e.g. tcp/127.0.0.1:7447; repeatable.")
]
RobotOption = Annotated[str, typer.Option("--robot", help="Name of the robot, part of its keys.")]
TlsOption = Annotated[
    str,
    typer.Option(
        "--tls",
        metavar="DIR",
        help="Certificate folder of this program (`farhand certs`): TLS on every link.",
    ),
]
RouterOption = Annotated[
    bool, typer.Option("--router", help="What is connected to is a Zenoh router (zenohd): be its client.")
]
InsecureOption = Annotated[
    bool, typer.Option("--insecure", help="Listen beyond this host without TLS: anybody may move the robot.")
]
RealtimeOption = Annotated[
    bool, typer.Option("--realtime/--no-realtime", help="Ask for the SCHED_FIFO real-time scheduler.")
]


_KINDS: dict[str, tuple[str, Kinds[Any]]] = {
    "margin": ("margin.kind", MARGINS),
    "predictor": ("operator.predictor", PREDICTORS),
    "solver": ("controller.solver", SOLVERS),
    "steer": ("steering.kind", DEVICES),
}


def chosen_scenario(
    name: str,
    settings: list[str] | None,
    *,
    guard: str | None = None,
    rate: float | None = None,
    **kinds: str | None,
) -> "Scenario":
    """The scenario with the options' replacements, judged together.

    Args:
        name: of the scenario, or its file.
        settings: KEY=VALUE, as said with --set; these go before the kinds.
        guard: what --guard says: on, off; None: nothing.
        rate: what --rate says (Hz); None: nothing.
        kinds: what --margin, --predictor, --solver and --steer say; None: nothing.

    Raises:
        InputError: one of them cannot be.
    """
    from farhand.runs.scenario import load_scenario, replace_settings

    replaced: dict[str, object] = {}
    for option, value in kinds.items():
        key, known = _KINDS[option]
        if value is not None:
            if option == "steer" and value.partition(":")[0] == "recorded":
                value, replaced["steering.recorded.run"] = "recorded", _recording(value)
            if value not in known:
                known.get(value, f"--{option}")
            replaced[key] = value
    if guard is not None:
        if guard not in ("on", "off"):
            raise InputError(f"--guard {guard!r}: must be on or off")
        replaced["guard.on"] = guard == "on"
    if rate is not None:
        replaced["operator.rate_hz"] = rate
    replaced.update(parse_setting(setting) for setting in settings or [])
    return at_the_rate_of_its_device(replace_settings(load_scenario(name), replaced))


def settings_at(host: str | None, settings: list[str] | None) -> list[str]:
    """What --set says, with --host: a model that is set is that of the arm behind it; raises InputError where empty."""
    said = settings or []
    if host is None:
        return said
    if not host:
        raise InputError("--host: is empty; give the address of the arm's controller")
    keys = dict(parse_setting(setting) for setting in said)
    kind = keys.get("robot.kind", "ur" if "robot.model" in keys else "")
    return [f"robot.host={host}", "robot.kind=ur", *said] if kind == "ur" else said


def on_a_real_arm(scenario: "Scenario", host: str, model: str = "") -> "Scenario":
    """The scenario with the real UR arm behind `host` in place of its own; raises InputError where that is no UR."""
    from farhand.runs.scenario import replace_settings

    known = model or scenario.robot.known_model
    if scenario.robot.urdf is not None and not model:
        return replace_settings(scenario, {"robot.kind": "ur", "robot.host": host})
    if not known.startswith("ur"):
        if model:
            raise InputError(f"--model {model!r}: is no UR arm; there are ur3, ur5, ur10, ur3e, ur5e")
        raise InputError(
            f"--host {host}: scenario {scenario.name} has no UR arm: say robot.model, such as ur5"
        )
    return replace_settings(scenario, {"robot.kind": "ur", "robot.model": known, "robot.host": host})


def at_the_rate_of_its_device(scenario: "Scenario") -> "Scenario":
    """The scenario, decided as often as what steers it asks for, where it says no rate itself; raises InputError."""
    from farhand.runs.scenario import replace_setting

    rate_hz = DEVICES.get(scenario.steering.kind, "steering.kind").rate_hz
    if rate_hz is None or scenario.operator.rate_hz is not None:
        return scenario
    return replace_setting(scenario, "operator.rate_hz", rate_hz)


def _recording(steer: str) -> str:
    """The file of `recorded:RUN`, which can be played; raises InputError."""
    from farhand.common.recording.place import recording_at
    from farhand.operator_side.steering.recorded.course import read_course

    _, _, run = steer.partition(":")
    if not run:
        raise InputError(
            "--steer recorded: names no run; say --steer recorded:RUN, a run's folder or its recording"
        )
    path = recording_at(Path(run)).resolve()
    read_course(path)
    return str(path)


def chosen_network(
    scenario: "Scenario", where: str, network: str | None, uplink: str | None, downlink: str | None
) -> "Network":
    """The network in force for a run of `scenario`, which was asked for as `where`; raises InputError.

    Where one direction is said, by the command line or the scenario, and the other is not, that one has the default
    all the same, and is told of: who says one may have forgotten the other.
    """
    from farhand.common.process.signals import say
    from farhand.runs.run import choose_network, left_open, read_choice

    choice = read_choice(network, uplink, downlink)
    chosen = choose_network(scenario, choice, default=DEFAULT_NETWORK, where=where)
    not_said = left_open(scenario, choice)
    if len(not_said) == 1:
        way = not_said[0]
        say(
            "network",
            f"the {way} is {DEFAULT_NETWORK}, the default, since only the other direction is said; "
            f"--{way} none leaves it unimpaired",
        )
    return chosen


def parse_setting(
    setting: str, option: str = "--set", such: str = "controller.gamma=0.3"
) -> tuple[str, object]:
    """Key and value of `controller.gamma=0.3`; raises InputError, which names the option and an example."""
    key, separator, text = setting.partition("=")
    if not separator or not key.strip():
        raise InputError(f"{option} {setting!r}: expected KEY=VALUE such as {such}")
    return key.strip(), parse_value(text.strip())


def parse_value(text: str) -> object:
    """A TOML value; what is not one is taken as a string."""
    try:
        return parse_toml(f"v = {text}", "--set")["v"]
    except InputError:
        return text


def print_rows(rows: list[tuple[str, str]]) -> None:
    """A name and a line each."""
    from rich.table import Table

    from farhand.common.process.console import page, whole

    table = Table.grid(padding=(0, 2))
    table.add_column(style="bold")
    table.add_column()
    for name, line in rows:
        table.add_row(name, line)
    console = page(emoji=False)
    console.print(whole(table, console))
