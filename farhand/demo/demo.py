"""The demo: operator, netem and robot as three processes, joined by nothing but Zenoh on loopback."""

import sys
import threading
from pathlib import Path

from rich.console import Console

from farhand.common.link.ports import free_ports
from farhand.common.process.signals import stop_event_on_signals
from farhand.common.timing.clock import SystemClock
from farhand.demo.children import Children
from farhand.demo.live_status import ReportReader, StatusView
from farhand.netem.timeline import load_timeline
from farhand.programs.wiring import OPERATOR_NAME
from farhand.robot_side.robots.registry import make_robot
from farhand.runs.conclude import conclude
from farhand.runs.run_folder import (
    NETEM,
    OPERATOR,
    RECORDING,
    ROBOT,
    make_run_folder,
    write_scenario,
)
from farhand.runs.scenario import Scenario

INTERRUPTED = "interrupted"
NAMES = ("netem", "robot", "operator")


def run_demo(
    scenario: Scenario,
    *,
    uplink: str,
    downlink: str,
    seed: int,
    time_limit: float,
    timeline: str | None,
    out: Path | None,
    as_json: bool,
) -> int:
    """Run the demo; returns its exit code: 0 safe and finished, 1 otherwise."""
    make_robot(scenario).close()  # raises now, in one line, if the robot cannot stand at the start
    if timeline:
        load_timeline(timeline)
    folder = make_run_folder(out, scenario.name)
    stop_event = stop_event_on_signals()
    console = Console(file=sys.stderr if as_json else sys.stdout)
    network = uplink if uplink == downlink else f"{uplink} / {downlink}"
    why = _run_programs(
        scenario,
        folder=folder,
        uplink=uplink,
        downlink=downlink,
        seed=seed,
        time_limit=time_limit,
        timeline=timeline,
        stop_event=stop_event,
        view=StatusView(f"{scenario.name} over {network}, margin {scenario.margin.kind}", console),
    )
    code = conclude(
        folder, scenario, console, uplink=uplink, downlink=downlink, seed=seed, why=why, as_json=as_json
    )
    return 1 if why == INTERRUPTED else code


def _run_programs(
    scenario: Scenario,
    *,
    folder: Path,
    uplink: str,
    downlink: str,
    seed: int,
    time_limit: float,
    timeline: str | None,
    stop_event: threading.Event,
    view: StatusView,
) -> str:
    """Start the three, show their progress, end them; returns what went wrong, or nothing."""
    clock = SystemClock()
    name = scenario.robot.kind
    operator_side, robot_side, report = (f"tcp/127.0.0.1:{port}" for port in free_ports(3))
    settings = str(write_scenario(scenario, folder))
    children = Children(folder, clock)
    reader: ReportReader | None = None
    try:
        netem = [
            "--listen-operator",
            operator_side,
            "--listen-robot",
            robot_side,
            "--stats",
            str(folder / NETEM),
        ]
        emulated = ["--uplink", uplink, "--downlink", downlink, "--seed", str(seed)]
        if timeline:
            emulated += ["--timeline", timeline]
        task = ["--scenario", settings, "--robot", name]
        named = ["--name", OPERATOR_NAME]
        reporting = ["--report", report, "--seed", str(seed), "--time-limit", str(time_limit)]
        files = ["--record", str(folder / RECORDING), "--result", str(folder / OPERATOR)]
        children.start("netem", ["netem", *netem, *emulated])
        children.start("robot", ["robot", *task, "--connect", robot_side, "--result", str(folder / ROBOT)])
        children.start(
            "operator", ["operator", *named, *task, "--connect", operator_side, *reporting, *files]
        )
        reader = ReportReader(report, name, clock)
        start_ns = clock.now_ns()
        with view:
            while True:
                ended = children.ended()
                view.update(reader.read(), (clock.now_ns() - start_ns) * 1e-9)
                if ended or stop_event.wait(0.1):
                    break
    finally:
        if reader is not None:
            reader.close()
        children.stop()
    if stop_event.is_set():
        return INTERRUPTED
    return _what_died(ended, children)


def _what_died(ended: dict[str, int], children: Children) -> str:
    """Why the run is no good, if a program ended that should not have."""
    for name in NAMES:
        code = ended.get(name)
        if code is None or (name == "operator" and code in (0, 1)):
            continue
        how = f"killed by signal {-code}" if code < 0 else f"ended with exit code {code}"
        words = children.last_words(name)
        return f"the {name} program was {how}" + (f": {words}" if words and code > 0 else "")
    return ""
