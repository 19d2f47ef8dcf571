"""The live status: what a run looks like to somebody at a terminal, fed by reports; what is old is shown as old."""

import sys
import threading
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass

import msgspec
from rich.console import Console, Group
from rich.live import Live
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from farhand.common.link.zenoh_link import ZenohLink, open_session
from farhand.common.messages.codec import Decoder
from farhand.common.messages.command import VelocityCommand
from farhand.common.messages.intervention import Intervention
from farhand.common.messages.keys import (
    check_robot_name,
    command_key,
    kind_of,
    mirror_key,
    report_key,
    scene_key,
)
from farhand.common.messages.report import ControlReport
from farhand.common.messages.scene import Scene
from farhand.common.process.signals import PeerWatch, stop_event_on_signals
from farhand.common.timing.clock import SystemClock
from farhand.demo.scene_words import SceneWords
from farhand.operator_side.accounts.result import GOOD_STATUS
from farhand.operator_side.sensing.standstill import side_words
from farhand.runs.freshness import Freshness, Hearing, Picture
from farhand.runs.words.guard import guard_words
from farhand.runs.words.standing import standing_words
from farhand.runs.words.units import milliseconds

REFRESH_HZ = 10
LINE_PERIOD = 2.0
SILENT_LINE_PERIOD = 10.0
TRAIL = 30
TRAIL_NS = 90_000_000
_BARS = "▁▂▃▄▅▆▇█"


def render(
    report: ControlReport | None,
    shown: Picture,
    elapsed: float,
    title: str,
    trail: list[float],
    around: str = "",
) -> Group:
    """The status of one instant: what is live in colours, what is not dimmed, and said.

    Args:
        report: newest report, None before the first.
        shown: how new it is, and the robot's state in it.
        elapsed: what the clock shows (s): it runs while operator and robot are live.
        title: what is running.
        trail: clearances so far, for the little chart (m).
        around: what is around the robot, in words.
    """
    clock = f"   {elapsed:5.1f} s" + ("" if shown.running else ", clock stands")
    head = Text.assemble(("farhand ", "bold"), (title, "cyan" if shown.running else "bold"), (clock, "dim"))
    told = [_told(shown)] if shown.said else []
    return Group(head, *told) if report is None else Group(head, *told, _grid(report, shown, trail, around))


def _told(shown: Picture) -> Text:
    """What people must be told, loudly where somebody is gone."""
    gone = Freshness.GONE in (shown.operator, shown.robot) and not shown.ended
    return Text(shown.said, style="bold white on red" if gone else "yellow")


def _grid(report: ControlReport, shown: Picture, trail: list[float], around: str) -> Table:
    """All values; each is as live as robot or operator, what follows from both as the older of them."""
    robot_style = "" if shown.robot is Freshness.LIVE else "dim"
    own_style = "" if shown.operator is Freshness.LIVE else "dim"
    both_style = own_style or robot_style

    def of_robot(text: str) -> Text:
        return Text(text, style=robot_style)

    grid = Table.grid(padding=(0, 3))
    grid.add_column(style="dim", justify="right", no_wrap=True)
    grid.add_column(min_width=30, overflow="fold")
    grid.add_column(style="dim", justify="right", no_wrap=True)
    grid.add_column(overflow="fold")
    bar = _bar(report, live=not robot_style)
    grid.add_row("targets", bar, "", of_robot(f"{report.target_index} of {report.target_count}"))
    trip = f"{milliseconds(report.rtt_mean)} ± {milliseconds(report.rtt_std)} ms"
    grid.add_row("round trip", of_robot(trip), "lost", of_robot(_percent(report.loss)))
    rate = report.state_rate if shown.robot is Freshness.LIVE else 0.0
    grid.add_row("margin", Text(margin_text(report), style=both_style), "states", of_robot(f"{rate:.0f} /s"))
    nearest, least = _mm(report.clearance), _mm(report.min_clearance)
    grid.add_row(
        "clearance", of_robot(f"{nearest}  (least {least})"), "refused", of_robot(str(report.refused_there))
    )
    chart = Text(sparkline(trail), style=robot_style or "cyan")
    grid.add_row("", chart, "stops", of_robot(str(report.stops)))
    grid.add_row("robot", _mode(report, shown), "filter", _filter(report, shown))
    if around:
        grid.add_row("scene", of_robot(around), "", "")
    guard = f"guard {guard_words(report.guard)}" if report.guard else ""
    for line, style in ((_stands(report), own_style), (_held(report), both_style), (guard, both_style)):
        if line:
            grid.add_row("", Text(line, style=style or "yellow"))
    return grid


def _bar(report: ControlReport, *, live: bool) -> ProgressBar:
    done = report.target_index / max(1, report.target_count)
    if live:
        return ProgressBar(total=1.0, completed=done, width=24)
    return ProgressBar(total=1.0, completed=done, width=24, complete_style="dim", finished_style="dim")


def margin_text(report: ControlReport) -> str:
    """How much more than the limit is kept: as larger obstacles, or in the barrier (the paper's sigma)."""
    if report.sigma == 0:
        return f"{report.inflation * 1e3:.0f} mm beyond the limit"
    return f"{report.sigma * 1e3:.0f} mm in the barrier"


def _mm(value: float | None) -> str:
    return "–" if value is None else f"{value * 1e3:.0f} mm"


def _percent(value: float | None) -> str:
    return "–" if value is None else f"{value * 100:.1f} %"


def sparkline(values: list[float], width: int = 30) -> str:
    """The last values as little bars, scaled to at most 0.3 m."""
    recent = values[-width:]
    return "".join(_BARS[min(7, max(0, int(v / 0.3 * 8)))] for v in recent)


def line(report: ControlReport | None, shown: Picture, elapsed: float, around: str = "") -> str:
    """The status as one line, for output that is not a terminal; no value of what is gone is in it."""
    if report is None or Freshness.GONE in (shown.operator, shown.robot):
        return f"{elapsed:5.1f} s  {shown.said}"
    held = f"  {_held(report)}" if _held(report) else ""
    guard = f"  guard {guard_words(report.guard)}" if report.guard is not None else ""
    return (
        f"{elapsed:5.1f} s  {shown.said}{'  ' if shown.said else ''}"
        f"target {report.target_index}/{report.target_count}  "
        f"rtt {milliseconds(report.rtt_mean)} ± {milliseconds(report.rtt_std)} ms  "
        f"clearance {_mm(report.clearance)}  "
        f"{'was ' if report.safety and not shown.running else ''}{report.safety or 'no robot'}"
        f"{'  filter intervening' if report.intervening else ''}{guard}{held}{'  ' if around else ''}{around}"
        f"{'  ' if report.stop_reason else ''}{_stands(report)}"
    )


def _stands(report: ControlReport) -> str:
    """Why zero is commanded; empty: it is not."""
    return standing_words(report.stop_reason, done=0 < report.target_count <= report.target_index)


def _held(report: ControlReport) -> str:
    """What holds the robot, or stands in its way, and which side is free."""
    if report.held_by:
        return f"no progress: {report.held_by}"
    if not report.blocked_by:
        return ""
    free = f"free {side_words(report.free_side)}" if report.free_side else "no side is free"
    return f"blocked by {report.blocked_by!r}: {free}"


def _mode(report: ControlReport, shown: Picture) -> Text:
    if report.safety is None:
        return Text("no state yet", style="dim")
    mode = report.safety
    if shown.robot is not Freshness.LIVE:
        return Text(f"was {mode}" + (f": {report.safety_reason}" if mode != "run" else ""), style="dim")
    style = {"run": "bold white on green", "hold": "bold black on yellow"}
    return Text.assemble(
        (f" {mode.upper()} ", style.get(mode, "bold white on red")),
        ("" if mode == "run" else f" {report.safety_reason}", "dim"),
    )


def _filter(report: ControlReport, shown: Picture) -> Text:
    live = Freshness.LIVE is shown.operator is shown.robot
    if report.status not in GOOD_STATUS:
        style = "bold white on red" if live else "dim"
        return Text(f" {report.status.upper()} " if live else f"was {report.status}", style=style)
    if report.intervening:
        what = f"intervening: {report.binding}" if report.binding else "intervening"
        return Text(f" {what.upper()} ", "bold white on blue") if live else Text(f"was {what}", "dim")
    said = "nothing to change" if report.mode == "run" else "not asked"
    return Text(said if live else f"was: {said}", style="dim")


@dataclass(frozen=True, slots=True)
class Arrived:
    """A report, and when it came on the reader's clock."""

    report: ControlReport
    at_ns: int


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
            told = line(report, shown, elapsed, self._around.words(now_ns))
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


class ReportReader:
    """Receives an operator's reports over Zenoh.

    Args:
        connect: the operator's report endpoint.
        name: the robot's name.
        clock: of this process.

    Attributes:
        released: session that gave control up to nobody, as an operator's program does when it ends; 0: none did.
        scenes: of the robot, that came with the last `read`, and when (ns).
    """

    def __init__(self, connect: str, name: str, clock: SystemClock) -> None:
        self._commands = mirror_key(name, kind_of(command_key(name)))
        self._scenes = mirror_key(name, kind_of(scene_key(name)))
        keys = [report_key(name), self._commands, self._scenes]
        self.link = ZenohLink(open_session([connect]), keys, clock)
        self._decoder, self._scene_decoder = Decoder(ControlReport), Decoder(Scene)
        self._command_decoder = Decoder(VelocityCommand)
        self.released = 0
        self.scenes: list[tuple[Scene, int]] = []

    def read(self) -> list[Arrived]:
        """Reports since the last call."""
        packets = []
        self.scenes = []
        for packet in self.link.receive():
            if packet.key == self._scenes:
                scene = self._scene_decoder.decode(packet.payload)
                self.scenes += [(scene, packet.arrived_ns)] if scene is not None else []
                continue
            if packet.key != self._commands:
                packets.append(packet)
                continue
            command = self._command_decoder.decode(packet.payload)
            if command is not None and command.mode == "release" and not command.successor:
                self.released = command.session
        found = [(self._decoder.decode(packet.payload), packet.arrived_ns) for packet in packets]
        return [Arrived(report, at_ns) for report, at_ns in found if report is not None]

    def connected(self) -> bool:
        """Whether the operator's program is connected."""
        return self.link.connected()

    def close(self) -> None:
        """Close the session."""
        self.link.close()


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
