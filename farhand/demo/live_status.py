"""The live status: what a run looks like to somebody at a terminal, fed by reports."""

import sys
import threading
from collections import deque
from collections.abc import Iterable

import msgspec
from rich.console import Console
from rich.live import Live

from farhand.common.messages.intervention import Intervention
from farhand.common.messages.keys import check_robot_name
from farhand.common.messages.scene import Scene
from farhand.common.process.signals import PeerWatch, stop_event_on_signals
from farhand.common.timing.clock import SystemClock
from farhand.demo.report_reader import Arrived, ReportReader
from farhand.demo.scene_words import SceneWords
from farhand.demo.status_drawing import line, render
from farhand.runs.freshness import Hearing, Picture

REFRESH_HZ = 10
LINE_PERIOD = 2.0
SILENT_LINE_PERIOD = 10.0
TRAIL = 30
TRAIL_NS = 90_000_000


class StatusView:
    """Draws reports on a terminal, or prints a line every 2 s where there is none.

    Args:
        title: what is running.
        console: where.
    """

    def __init__(self, title: str, console: Console) -> None:
        self._title, self._console = title, console
        self._trail: deque[float] = deque(maxlen=TRAIL)
        self._hearing = Hearing()
        self._trail_ns: int | None = None  # of its newest value, on the operator's clock
        self._live: Live | None = None
        self._start_ns: int | None = None
        self._clock = 0.0
        self._said_ns: int | None = None
        self._said = ("", "")
        self._guard: Intervention | None = None  # the newest since the last line
        self._around = SceneWords()
        self._told_around = ""  # in the last line that said it: lines stay, so that it need not be said again

    def __enter__(self) -> "StatusView":
        if self._console.is_terminal:
            self._live = Live(console=self._console, auto_refresh=False, transient=True)
            self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._live is not None:
            self._live.stop()

    def note(self, text: str) -> None:
        """One line above the status."""
        self._console.print(text, style="dim", markup=False, highlight=False, soft_wrap=True)

    def see(self, scenes: Iterable[tuple[Scene, int]]) -> None:
        """Scenes of the robot that came since the last call, and when (ns)."""
        for scene, at_ns in scenes:
            self._around.take(scene, at_ns)

    def update(self, reports: Iterable[Arrived], now_ns: int, connected: bool, released: int = 0) -> None:
        """Show what may be shown at `now_ns`.

        Args:
            reports: that came since the last call.
            now_ns: on the clock that stamped their arrival.
            connected: whether the reader is connected to the operator's program.
            released: session of an operator that gave control up to nobody, as it does when it ends; 0: none did.
        """
        self._hearing.released = released
        if self._start_ns is None:
            self._start_ns = now_ns
        for arrived in reports:
            self._guard = arrived.report.guard or self._guard
            if self._hearing.take(arrived.report, arrived.at_ns) and arrived.report.clearance is not None:
                self._note(arrived.report.clearance, arrived.report.t_sent_ns)
        shown = self._hearing.picture(now_ns, connected)
        elapsed = (now_ns - self._start_ns) * 1e-9
        if shown.running:
            self._clock = elapsed
        report = self._hearing.report
        if self._live is not None:
            clock = self._clock if report is not None else elapsed
            drawn = render(report, shown, clock, self._title, list(self._trail), self._around.words(now_ns))
            self._live.update(drawn, refresh=True)
        elif self._is_due(shown, now_ns):
            if report is not None:
                report, self._guard = msgspec.structs.replace(report, guard=self._guard), None
            around = self._around.words(now_ns)
            told = line(report, shown, elapsed, "" if around == self._told_around else around)
            self._told_around = around if around in told else self._told_around
            self._console.print(told, highlight=False, markup=False, soft_wrap=True)

    def _note(self, clearance: float, sent_ns: int) -> None:
        """A value of the chart each TRAIL_NS, however many reports there are."""
        last_ns = self._trail_ns
        if last_ns is None or not 0 <= sent_ns - last_ns < TRAIL_NS:
            self._trail.append(clearance)
            self._trail_ns = sent_ns

    def _is_due(self, shown: Picture, now_ns: int) -> bool:
        """Whether a line is to be printed: at each change, every 2 s while all is live, else every 10 s."""
        what = (shown.operator.value, shown.robot.value)
        period = LINE_PERIOD if shown.running else SILENT_LINE_PERIOD
        if what == self._said and self._said_ns is not None and now_ns - self._said_ns < period * 1e9:
            return False
        self._said, self._said_ns = what, now_ns
        return True


def watch_operator(connect: str, name: str) -> int:
    """`farhand watch`: until Ctrl-C."""
    check_robot_name(name)
    stop_event: threading.Event = stop_event_on_signals()
    clock = SystemClock()
    reader = ReportReader(connect, name, clock)
    PeerWatch("watch", connect, reader.link.connected, stop_event)
    try:
        with StatusView(f"{name} at {connect}", Console(file=sys.stdout, markup=False)) as view:
            while not stop_event.wait(1.0 / REFRESH_HZ):
                reports = reader.read()
                view.see(reader.scenes)
                view.update(reports, clock.now_ns(), reader.connected(), reader.released)
    finally:
        reader.close()
    return 0
