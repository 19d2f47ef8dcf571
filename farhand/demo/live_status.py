"""The live status: what a run looks like to somebody at a terminal. A program of its own, fed by reports."""

import sys
import threading

from rich.console import Console, Group
from rich.live import Live
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from farhand.common.link.zenoh_link import ZenohLink, open_session
from farhand.common.messages.codec import Decoder
from farhand.common.messages.keys import check_robot_name, report_key
from farhand.common.messages.report import ControlReport
from farhand.common.process.signals import PeerWatch, stop_event_on_signals
from farhand.common.timing.clock import SystemClock
from farhand.runs.units import milliseconds

REFRESH_HZ = 10
LINE_PERIOD = 2.0
_BARS = "▁▂▃▄▅▆▇█"


def render(report: ControlReport | None, elapsed: float, title: str, trail: list[float]) -> Group:
    """The status of one instant.

    Args:
        report: newest report, None before the first.
        elapsed: since the start (s).
        title: what is running.
        trail: clearances so far, for the little chart (m).
    """
    head = Text.assemble(("farhand ", "bold"), (title, "cyan"), (f"   {elapsed:5.1f} s", "dim"))
    if report is None:
        return Group(head, Text("starting operator, netem and robot …", style="dim"))
    grid = Table.grid(padding=(0, 3))
    grid.add_column(style="dim", justify="right")
    grid.add_column(min_width=30)
    grid.add_column(style="dim", justify="right")
    grid.add_column()
    done = report.target_index / max(1, report.target_count)
    bar = ProgressBar(total=1.0, completed=done, width=24)
    loss = f"{report.loss * 100:.1f} %"
    grid.add_row("targets", bar, "", f"{report.target_index} of {report.target_count}")
    grid.add_row(
        "round trip",
        f"{milliseconds(report.rtt_mean)} ± {milliseconds(report.rtt_std)} ms",
        "loss",
        loss,
    )
    margin = f"{report.inflation * 1e3:.0f} mm" if report.sigma == 0 else f"sigma {report.sigma:.3f}"
    grid.add_row("margin", margin, "states", f"{report.state_rate:.0f} /s")
    nearest = "–" if report.clearance is None else f"{report.clearance * 1e3:.0f} mm"
    least = "–" if report.min_clearance is None else f"{report.min_clearance * 1e3:.0f} mm"
    grid.add_row("clearance", f"{nearest}  (least {least})", "refused", str(report.refused_there))
    grid.add_row("", Text(sparkline(trail), style="cyan"), "stops", str(report.stops))
    grid.add_row("robot", _mode(report), "filter", _filter(report))
    if report.stop_reason:
        grid.add_row("", Text(report.stop_reason, style="yellow"))
    return Group(head, grid)


def sparkline(values: list[float], width: int = 30) -> str:
    """The last values as little bars, scaled to at most 0.3 m."""
    recent = values[-width:]
    return "".join(_BARS[min(7, max(0, int(v / 0.3 * 8)))] for v in recent)


def line(report: ControlReport, elapsed: float) -> str:
    """The status as one line, for output that is not a terminal."""
    clearance = "–" if report.clearance is None else f"{report.clearance * 1e3:.0f} mm"
    return (
        f"{elapsed:5.1f} s  target {report.target_index}/{report.target_count}  "
        f"rtt {milliseconds(report.rtt_mean)} ± {milliseconds(report.rtt_std)} ms  clearance {clearance}  "
        f"{report.safety or 'no robot'}{'  filter intervening' if report.intervening else ''}"
        f"{'  ' if report.stop_reason else ''}{report.stop_reason}"
    )


def _mode(report: ControlReport) -> Text:
    style = {"run": "bold white on green", "hold": "bold black on yellow"}
    mode = report.safety or "no robot"
    return Text.assemble(
        (f" {mode.upper()} ", style.get(mode, "bold white on red")),
        ("" if mode == "run" else f" {report.safety_reason}", "dim"),
    )


def _filter(report: ControlReport) -> Text:
    if report.status not in ("optimal", "shortcut", "idle"):
        return Text(f" {report.status.upper()} ", style="bold white on red")
    if report.intervening:
        return Text(f" INTERVENING: {report.binding} ", style="bold white on blue")
    return Text("passing through" if report.mode == "run" else "idle", style="dim")


class StatusView:
    """Draws reports on a terminal, or prints a line every 2 s where there is none.

    Args:
        title: what is running.
        console: where.
    """

    def __init__(self, title: str, console: Console) -> None:
        self._title, self._console = title, console
        self._trail: list[float] = []
        self._report: ControlReport | None = None
        self._live: Live | None = None
        self._said = -LINE_PERIOD

    def __enter__(self) -> "StatusView":
        if self._console.is_terminal:
            self._live = Live(
                render(None, 0.0, self._title, []), console=self._console, auto_refresh=False, transient=True
            )
            self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._live is not None:
            self._live.stop()

    def update(self, reports: list[ControlReport], elapsed: float) -> None:
        """Show the newest of some reports, `elapsed` s after the start."""
        for report in reports:
            self._report = report
            if report.clearance is not None:
                self._trail.append(report.clearance)
        if self._live is not None:
            self._live.update(render(self._report, elapsed, self._title, self._trail), refresh=True)
        elif self._report is not None and elapsed - self._said >= LINE_PERIOD:
            self._said = elapsed
            self._console.print(line(self._report, elapsed), highlight=False)


class ReportReader:
    """Receives an operator's reports over Zenoh.

    Args:
        connect: the operator's report endpoint.
        name: the robot's name.
        clock: of this process.
    """

    def __init__(self, connect: str, name: str, clock: SystemClock) -> None:
        self.link = ZenohLink(open_session([connect]), [report_key(name)], clock)
        self._decoder = Decoder(ControlReport)

    def read(self) -> list[ControlReport]:
        """Reports since the last call."""
        found = [self._decoder.decode(packet.payload) for packet in self.link.receive()]
        return [report for report in found if report is not None]

    def close(self) -> None:
        """Close the session."""
        self.link.close()


def watch_operator(connect: str, name: str) -> int:
    """`farhand watch`: until Ctrl-C."""
    check_robot_name(name)
    stop_event: threading.Event = stop_event_on_signals()
    clock = SystemClock()
    reader = ReportReader(connect, name, clock)
    start_ns = clock.now_ns()
    PeerWatch("watch", connect, reader.link.connected, stop_event)
    try:
        with StatusView(f"{name} at {connect}", Console(file=sys.stdout)) as view:
            while not stop_event.wait(1.0 / REFRESH_HZ):
                view.update(reader.read(), (clock.now_ns() - start_ns) * 1e-9)
    finally:
        reader.close()
    return 0
