"""The demo: operator, netem and robot as three processes, joined by nothing but Zenoh on loopback."""

import os
import tempfile
import threading
from pathlib import Path

from farhand.common.link.ports import free_ports
from farhand.common.process.called import called
from farhand.common.process.console import page
from farhand.common.process.signals import say, stop_event_on_signals
from farhand.common.timing.clock import SystemClock
from farhand.demo.children import Children
from farhand.demo.live_status import ReportReader, StatusView
from farhand.operator_side.control.registry import make_controller
from farhand.programs.command_line import (
    ConsoleWords,
    NetemWords,
    OperatorWords,
    RecordWords,
    RobotWords,
    Words,
)
from farhand.programs.compiling import prepare_aloud, prepare_robot_aloud
from farhand.programs.wiring import OPERATOR_NAME
from farhand.report.write import conclude_report
from farhand.runs.conclude import conclude
from farhand.runs.files import NETEM, OPERATOR, RECORDING, ROBOT
from farhand.runs.run import Run
from farhand.runs.run_folder import make_run_folder, write_scenario
from farhand.runs.why import INTERRUPTED

MEMORY = "/dev/shm"
RECORD = RecordWords.COMMAND
NAMES = ("netem", "robot", "operator", "console", RECORD)


def run_demo(run: Run, *, out: Path | None, as_json: bool, force: bool = False, browser: bool = False) -> int:
    """Run the demo, by hand in a `browser` or by itself; returns its exit code: 0 safe and finished, 1 otherwise.

    Raises InputError in one line, before anything is started, where the robot cannot stand at the start.
    """
    prepare_robot_aloud(run.scenario, lambda line: say("demo", line))  # the robot's program finds it compiled
    run.check()
    folder = make_run_folder(out, run.scenario.name, force=force)
    stop_event = stop_event_on_signals()
    console = page(stderr=as_json)
    prepare_aloud(make_controller(run.scenario.controller), lambda line: say("demo", line))
    title = f"{run.scenario.name} over {run.network}, margin {run.scenario.margin.kind}"
    with tempfile.TemporaryDirectory(prefix="farhand-demo-", dir=_memory()) as left_in:
        left = Path(left_in)
        why, note = _run_programs(run, folder, left, stop_event, StatusView(title, console), browser=browser)
        code = conclude(run, folder, console, why=why, as_json=as_json, left_in=left, note=note)
    conclude_report(folder, console)
    if not as_json and not browser:
        console.print(f"to drive it yourself: {called()} demo --steer browser", highlight=False)
    return 1 if why == INTERRUPTED else code


def has_desktop() -> bool:
    """Whether a browser that is opened here is seen by anybody."""
    return any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY"))


def _memory() -> str | None:
    """A folder in memory for the results until they are read, so that a full disk costs none; None: there is none."""
    return MEMORY if os.access(MEMORY, os.W_OK) else None


def _run_programs(
    run: Run, folder: Path, left: Path, stop_event: threading.Event, view: StatusView, *, browser: bool
) -> tuple[str, str]:
    """Start the three, a recorder, and a console if a browser steers, show their progress, end them.

    Returns what went wrong, and what the recording lacks.
    """
    clock = SystemClock()
    *ports, page, control = free_ports(5)
    operator_side, robot_side, report = (f"tcp/127.0.0.1:{port}" for port in ports)
    children = Children(folder, clock)
    reader: ReportReader | None = None
    try:
        name = run.scenario.robot.kind
        netem = f"tcp/127.0.0.1:{control}"
        wanted = _words(run, folder, left, operator_side, robot_side, report, netem)
        wanted.append(RecordWords(out=str(folder / RECORDING), connect=report, netem=netem, robot=name))
        if browser:
            listen = f"127.0.0.1:{page}"
            wanted.append(ConsoleWords(connect=report, listen=listen, robot=name, opens=has_desktop()))
            view.note(f"drive at http://{listen}/")
        for words in wanted:
            children.start(words.COMMAND, words.words())
        view.note(
            f"elsewhere: {called()} watch --connect {report} --robot {name}; to stop it: estop in place of watch"
        )
        reader = ReportReader(report, run.scenario.robot.kind, clock)
        with view:
            while True:
                ended = children.ended(beside=(RECORD,))
                view.update(reader.read(), clock.now_ns(), reader.connected())
                if ended or stop_event.wait(0.1):
                    break
    finally:
        if reader is not None:
            reader.close()
        if not stop_event.is_set():
            children.wait_for(RECORD)  # it ends with the operator's program, and has its last words then
        children.stop()
    recorded = children.ended().get(RECORD)
    lacking = _what_died({RECORD: recorded}, children) if recorded is not None else ""
    return INTERRUPTED if stop_event.is_set() else _what_died(ended, children), lacking


def _words(
    run: Run, folder: Path, left: Path, operator_side: str, robot_side: str, report: str, control: str
) -> list[Words]:
    """The command lines of the three programs, in the order of their start."""
    scenario, robot = str(write_scenario(run, folder)), run.scenario.robot.kind
    return [
        NetemWords(
            listen_operator=operator_side,
            listen_robot=robot_side,
            uplink=run.network.uplink.text,
            downlink=run.network.downlink.text,
            seed=run.seed,
            timeline=run.timeline,
            control=control,
            stats=str(left / NETEM),
        ),
        RobotWords(scenario=scenario, robot=robot, connect=(robot_side,), result=str(left / ROBOT)),
        OperatorWords(
            name=OPERATOR_NAME,
            scenario=scenario,
            robot=robot,
            connect=(operator_side,),
            report=report,
            seed=run.seed,
            time_limit=None if run.scenario.steering.kind == "remote" else run.time_limit,
            result=str(left / OPERATOR),
        ),
    ]


def _what_died(ended: dict[str, int], children: Children) -> str:
    """Why the run is no good, if a program ended that should not have."""
    for name in NAMES:
        code = ended.get(name)
        if code is None or (name == "operator" and code in (0, 1)) or (name == RECORD and code == 0):
            continue
        how = f"killed by signal {-code}" if code < 0 else f"ended with exit code {code}"
        words = children.last_words(name)
        return f"the {name} program was {how}" + (f": {words}" if words and code > 0 else "")
    return ""
