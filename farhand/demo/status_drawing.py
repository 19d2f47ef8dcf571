"""The status of one instant, as a picture of a terminal or as one line; what is old is drawn as old."""

from rich.console import Group
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from farhand.common.messages.report import ControlReport
from farhand.operator_side.accounts.result import GOOD_STATUS
from farhand.operator_side.sensing.standstill import side_words
from farhand.runs.freshness import Freshness, Picture
from farhand.runs.words.guard import guard_words
from farhand.runs.words.standing import standing_words
from farhand.runs.words.units import milliseconds

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
