"""The table as people read it in a terminal and in Markdown."""

import math
from collections.abc import Callable, Sequence

from rich.table import Table

from farhand.trials.leaderboard.plan.board import command_of
from farhand.trials.leaderboard.plan.rows import Row
from farhand.trials.leaderboard.tasks.posing import Posed
from farhand.trials.leaderboard.telling.cells import Cell, cells_by

NOTE = (
    "safe: no part of the robot nearer than d_min; done: safe, and every target reached. "
    "A run that crashed, or in which the method raised, counts as neither safe nor done. "
    "evadable: runs with a violation that the robot could have evaded. "
    "time: median over the ideal, undelayed operator's on the same task."
)
INTERVALS = (
    "Clopper and Pearson's, 95 %. In cells over several networks or operators the same tasks recur, so "
    "that there they are narrower than those of as many independent tasks would be."
)
"""What intervals are, where they are shown."""
NOTHING = "–"
"""Where there is no figure."""


def percent(share: float | None) -> str:
    """A rate in %, of which 100 means all of them, and 0 none; halves are rounded up. `pc` in page.js writes alike."""
    if share is None:
        return NOTHING
    if 0.0 < share < 0.01 or 0.99 < share < 1.0:
        return _tenths(share)
    return str(math.floor(100.0 * share + 0.5))


def bound(share: float) -> str:
    """An end of an interval in %, in tenths, of which 100 and 0 are exact; as `bound` in page.js."""
    return _tenths(share) if 0.0 < share < 1.0 else percent(share)


def _tenths(share: float) -> str:
    return f"{min(max(math.floor(1000.0 * share + 0.5), 1), 999) / 10:.1f}"


def millimetres(length: float | None) -> str:
    """A length in m as mm; a dash for nothing."""
    if length is None:
        return NOTHING
    return _number(1e3 * length, 1 if 0.0 < abs(length) < 1e-3 else 0)


def _number(value: float | None, digits: int) -> str:
    """With a minus sign, where it is below 0, and a dash for nothing."""
    return NOTHING if value is None else f"{value:.{digits}f}".replace("-", "−")


def _measured(cell: Cell) -> int:
    """Runs of a cell with a result."""
    return cell.runs - cell.crashed


def _of_measured(cell: Cell, text: str) -> str:
    """What is said of a cell's runs; a dash where all of them crashed."""
    return text if _measured(cell) else NOTHING


def by_method(rows: Sequence[Row]) -> Table:
    """A line a method and operator."""
    table = Table(caption=NOTE, caption_justify="left", caption_style="")
    for name in ("operator", "method"):
        table.add_column(name, no_wrap=True)
    for name in ("runs", "safe %", "done %", "evadable", "deepest mm", "least mm", "time", "stops"):
        table.add_column(name, justify="right")
    shown = ""
    for (operator, method), cell in cells_by(rows, lambda row: (row.operator, row.method)).items():
        if shown and operator != shown:
            table.add_section()
        table.add_row("" if operator == shown else operator, method, *_figures(cell))
        shown = operator
    return table


def by_scene(rows: Sequence[Row], measure: str = "safe") -> Table:
    """A line a method, a column a scene: how many of the runs were safe, in %."""
    table = Table(title=f"{measure}, % of the runs", title_justify="left", title_style="")
    scenes = list(dict.fromkeys(row.scene for row in rows))
    table.add_column("method", no_wrap=True)
    for scene in scenes:
        table.add_column(scene.replace("movers-", "m "), justify="right")
    cells = cells_by(rows, lambda row: (row.method, row.scene))
    for method in dict.fromkeys(row.method for row in rows):
        found = [cells.get((method, scene)) for scene in scenes]
        table.add_row(
            method,
            *(
                NOTHING if c is None else percent(c.safe_rate if measure == "safe" else c.success_rate)
                for c in found
            ),
        )
    return table


def redrawn(posed: Sequence[Posed]) -> str:
    """How many draws were thrown away, scene by scene, in one line."""
    words = []
    for scene in dict.fromkeys(task.scene for task in posed):
        own = [task for task in posed if task.scene == scene and not task.error]
        unfit, undoable = sum(task.unfit for task in own), sum(task.undoable for task in own)
        if unfit or undoable:
            words.append(f"{scene} {unfit} and {undoable} for {len(own)}")
    return "; ".join(words) or "none"


def to_markdown(rows: Sequence[Row], posed: Sequence[Posed], command: str) -> str:
    """The table for documents, with the command that made it."""
    lines = [
        f"    {command}",
        "",
        "| operator | method | runs | crashed | safe % (95 %) | done % (95 %) | violations | evadable | run over | ",
    ]
    lines[-1] += "deepest mm | least mm | time | way | filtered % | guard % | stops | smoothness |"
    lines.append("|" + "---|" * 17)
    for (operator, method), c in cells_by(rows, lambda row: (row.operator, row.method)).items():
        lines.append("| " + " | ".join([operator, method, *_long(c)]) + " |")
    lines += ["", "Safe runs by scene, %:", ""]
    lines += _scenes(rows, lambda c: f"{percent(c.safe_rate)} ({c.safe}/{c.runs})")
    lines += ["", "Runs by scene with a violation that the robot could have evaded:", ""]
    lines += _scenes(rows, lambda c: _of_measured(c, f"{c.could_evade}/{_measured(c)}"))
    for what in ("scene", "network"):
        lines += ["", f"By {what}, all operators:", "", *_breakdown(rows, what)]
    crashed = [row for row in rows if row.error]
    lines += ["", "The deepest violation of each method, and how to have it again:", "", *_worst(rows, posed)]
    lines += [
        "",
        f"{NOTE} Intervals: {INTERVALS}",
        "",
        f"Draws thrown away (unfit and undoable, for so many tasks): {redrawn(posed)}.",
    ]
    if crashed:
        lines += ["", f"{len(crashed)} of {len(rows)} runs crashed."]
    return "\n".join(lines) + "\n"


def _scenes(rows: Sequence[Row], text: Callable[[Cell], str]) -> list[str]:
    """A line a method, a column a scene."""
    scenes = list(dict.fromkeys(row.scene for row in rows))
    lines = ["| method | " + " | ".join(scenes) + " |", "|" + "---|" * (1 + len(scenes))]
    cells = cells_by(rows, lambda row: (row.method, row.scene))
    for method in dict.fromkeys(row.method for row in rows):
        found = [cells.get((method, scene)) for scene in scenes]
        lines.append(f"| {method} | " + " | ".join(NOTHING if c is None else text(c) for c in found) + " |")
    return lines


def _breakdown(rows: Sequence[Row], what: str) -> list[str]:
    """A line a method and scene or network, with the figures that claims are made of."""
    lines = [
        f"| method | {what} | runs | safe | at most unsafe, % | evadable | run over | done | time | least mm | "
        "least of the tool mm | round trip ms |",
        "|" + "---|" * 12,
    ]
    for (method, name), c in cells_by(rows, lambda row: (row.method, getattr(row, what))).items():
        figures = (
            method, name, str(c.runs), str(c.safe), f"{100 * (1 - c.safe_low):.2f}",
            _of_measured(c, str(c.could_evade)), _of_measured(c, str(c.run_over)), str(c.successes),
            _number(c.time, 2), millimetres(c.least), millimetres(c.least_tool), millimetres(c.rtt),
        )  # fmt: skip
        lines.append("| " + " | ".join(figures) + " |")
    return lines


def _worst(rows: Sequence[Row], posed: Sequence[Posed]) -> list[str]:
    seed = posed[0].seed if posed else 0
    lines = []
    for method, cell in cells_by(rows, lambda row: row.method).items():
        worst = cell.worst
        if worst is None:
            lines.append(f"- {method}: all {cell.runs} runs crashed")
        elif not worst.violations:
            lines.append(f"- {method}: none in {_measured(cell)} runs")
        else:
            depth = f"{1e3 * worst.violation_depth:.1f}"
            lines.append(
                f"- {method}: {depth} mm for {worst.violation_seconds:.2f} s: `{command_of(worst, seed)}`"
            )
    return lines


def _figures(cell: Cell) -> tuple[str, ...]:
    return (
        str(cell.runs),
        percent(cell.safe_rate),
        percent(cell.success_rate),
        _of_measured(cell, str(cell.could_evade)),
        millimetres(cell.depth) if cell.violations else NOTHING,
        millimetres(cell.least),
        _number(cell.time, 2),
        _of_measured(cell, f"{cell.stops:.1f}"),
    )


def _long(c: Cell) -> list[str]:
    def rate(share: float | None, low: float, high: float) -> str:
        return f"{percent(share)} ({bound(low)}–{bound(high)})"

    return [
        str(c.runs),
        str(c.crashed),
        rate(c.safe_rate, c.safe_low, c.safe_high),
        rate(c.success_rate, c.success_low, c.success_high),
        _of_measured(c, str(c.violations)),
        _of_measured(c, str(c.evadable)),
        _of_measured(c, str(c.run_over)),
        millimetres(c.depth) if c.violations else NOTHING,
        millimetres(c.least),
        _number(c.time, 2),
        _number(c.path, 2),
        _of_measured(c, percent(c.filtered)),
        _of_measured(c, percent(c.guarded)),
        _of_measured(c, f"{c.stops:.1f}"),
        _number(c.smoothness, 2),
    ]
