"""The demo: operator, netem and robot as processes of their own, joined by nothing but Zenoh on loopback."""

import os
import tempfile
import threading
from dataclasses import dataclass
from pathlib import Path

from farhand.common.process.called import called
from farhand.common.process.console import page
from farhand.common.process.outputs import check_folder
from farhand.common.process.signals import say, stop_event_on_signals
from farhand.common.timing.clock import SystemClock
from farhand.demo.cast import BESIDE, CAMERA, RECORD, STEER, Cast, Hands, cast_of
from farhand.demo.children import Children
from farhand.demo.live_status import StatusView
from farhand.demo.report_reader import ReportReader
from farhand.operator_side.control.registry import make_controller
from farhand.operator_side.devices.sources import SOURCES, check_library
from farhand.programs.command_line import ConsoleWords, NetemWords
from farhand.programs.compiling import prepare_aloud, prepare_robot_aloud
from farhand.report.write import conclude_report
from farhand.runs.conclude import conclude
from farhand.runs.run import Run
from farhand.runs.run_folder import make_run_folder
from farhand.runs.why import INTERRUPTED

MEMORY = "/dev/shm"
ALONE = Hands()


@dataclass(frozen=True, slots=True)
class _End:
    """Attributes:
    why: what went wrong; empty: nothing.
    note: what else there is to say, such as what the recording lacks.
    """

    why: str
    note: str


def run_demo(run: Run, *, out: Path | None, as_json: bool, force: bool = False, hands: Hands = ALONE) -> int:
    """Run the demo, by hand or by itself; returns its exit code: 0 safe and finished, 1 otherwise.

    Raises InputError in one line, before anything is started, where the robot cannot stand at the start.
    """
    check_folder(out, "--out")
    check_library(run.scenario.steering.kind)
    prepare_robot_aloud(run.scenario, lambda line: say("demo", line))  # the robot's program finds it compiled
    run.check()
    folder = make_run_folder(out, run.scenario.name, force=force)
    stop_event = stop_event_on_signals()
    console = page(stderr=as_json)
    prepare_aloud(make_controller(run.scenario.controller), lambda line: say("demo", line))
    title = f"{run.scenario.name} over {run.network}, margin {run.scenario.margin.kind}"
    with tempfile.TemporaryDirectory(prefix="farhand-demo-", dir=_memory()) as left_in:
        left = Path(left_in)
        cast = cast_of(run, folder, left, hands)
        end = _play(cast, run.scenario.robot.kind, folder, stop_event, StatusView(title, console))
        code = conclude(run, folder, console, why=end.why, as_json=as_json, left_in=left, note=end.note)
    conclude_report(folder, console)
    if not as_json and not hands.browser and run.scenario.steering.kind not in SOURCES:
        console.print(f"to drive it yourself: {called()} demo --steer browser", highlight=False)
    return 1 if end.why == INTERRUPTED else code


def has_desktop() -> bool:
    """Whether a browser that is opened here is seen by anybody."""
    return any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY"))


def _memory() -> str | None:
    """A folder in memory for the results until they are read, so that a full disk costs none; None: there is none."""
    return MEMORY if os.access(MEMORY, os.W_OK) else None


def _play(cast: Cast, robot: str, folder: Path, stop_event: threading.Event, view: StatusView) -> _End:
    """Start the programs, show their progress, end them."""
    clock = SystemClock()
    children = Children(folder, clock)
    reader: ReportReader | None = None
    gone: dict[str, int] = {}
    said = ""
    try:
        for words in cast.programs:
            children.start(words.COMMAND, words.words())
        elsewhere = f"{called()} watch --connect {cast.report} --robot {robot}"
        view.note(f"elsewhere: {elsewhere}; to stop it: estop in place of watch")
        if any(words.COMMAND == STEER for words in cast.programs):
            view.note(f"to see it: {called()} console --connect {cast.report} --robot {robot}")
        reader = ReportReader(cast.report, robot, clock)
        filmed, shut = True, bool(cast.page)
        with view:
            while not gone and not stop_event.wait(0.1):
                ended = children.ended()
                gone = {name: code for name, code in ended.items() if name not in BESIDE}
                if shut and children.has_said(ConsoleWords.COMMAND, ConsoleWords.SAYS):
                    shut = False
                    view.note(f"{ConsoleWords.SAYS} {cast.page}")
                if filmed and CAMERA in ended:
                    filmed = False
                    view.note(f"no camera any more: {children.last_words(CAMERA)}")
                if (words_of_hand := children.last_words(STEER)) != said:
                    said = words_of_hand
                    view.note(said)
                reports = reader.read()
                view.see(reader.scenes)
                view.update(reports, clock.now_ns(), reader.connected())
    finally:
        if reader is not None:
            reader.close()
        if stop_event.is_set():
            children.ask(beside=(RECORD, NetemWords.COMMAND))
        children.wait_for(RECORD)  # it ends with the operator's program, and asks the emulator once more then
        children.stop(patient=(RECORD,))
    recorded = children.ended().get(RECORD, 0)
    note = _how(RECORD, recorded, children) if recorded else ""
    return _End(INTERRUPTED if stop_event.is_set() else _what_died(cast, gone, children), note)


def _what_died(cast: Cast, ended: dict[str, int], children: Children) -> str:
    """Why the run is no good, if a program ended that should not have."""
    for name in (words.COMMAND for words in cast.programs):
        code = ended.get(name)
        if code is not None and not (name == "operator" and code in (0, 1)):
            return _how(name, code, children)
    return ""


def _how(name: str, code: int, children: Children) -> str:
    patience = children.killed.get(name)
    if patience is not None:
        return f"the {name} program did not end within {patience:g} s of being asked to, and was killed"
    how = f"killed by signal {-code}" if code < 0 else f"ended with exit code {code}"
    words = children.last_words(name)
    return f"the {name} program was {how}" + (f": {words}" if words and code > 0 else "")
