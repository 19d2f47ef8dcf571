"""The table as people read it in a terminal and in Markdown."""

from collections.abc import Callable, Sequence

from rich.table import Table

from farhand.trials.leaderboard.board import command_of
from farhand.trials.leaderboard.cells import Cell, cells_by
from farhand.trials.leaderboard.posing import Posed
from farhand.trials.leaderboard.rows import Row

NOTE = (
    "safe: no part of the robot nearer than d_min; done: safe, and every target reached. Clopper-Pearson, 95 %. "
    "evadable: runs with a violation that the robot could have evaded. "
    "time: median over the ideal, undelayed operator's on the same task."
)


def percent(share: float | None) -> str:
    """A rate of which 100 % means all of them, and 0 none."""
    if share is None:
        return "–"
    text = f"{100.0 * share:.1f}" if 0.99 < share < 1.0 or 0.0 < share < 0.01 else f"{100.0 * share:.0f}"
    return "99.9" if text == "100.0" else "0.1" if text == "0.0" else text


def millimetres(length: float | None) -> str:
    """A length in m as mm; a dash for nothing."""
    if length is None:
        return "–"
    return f"{length * 1e3:.1f}" if 0.0 < abs(length) < 1e-3 else f"{length * 1e3:.0f}"


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
                "–" if c is None else percent(c.safe_rate if measure == "safe" else c.success_rate)
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
        "| operator | method | runs | safe % (95 %) | done % (95 %) | violations | evadable | run over | deepest mm | ",
    ]
    lines[-1] += "least mm | time | path | filtered % | guard % | stops | smoothness |"
    lines.append("|" + "---|" * 16)
    for (operator, method), c in cells_by(rows, lambda row: (row.operator, row.method)).items():
        lines.append("| " + " | ".join([operator, method, *_long(c)]) + " |")
    lines += ["", "Safe runs by scene, %:", ""]
    lines += _scenes(rows, lambda c: f"{percent(c.safe_rate)} ({c.safe}/{c.runs})")
    lines += ["", "Runs by scene with a violation that the robot could have evaded:", ""]
    lines += _scenes(rows, lambda c: f"{c.could_evade}/{c.runs}")
    for what in ("scene", "network"):
        lines += ["", f"By {what}, all operators:", "", *_breakdown(rows, what)]
    crashed = [row for row in rows if row.error]
    lines += ["", "The deepest violation of each method, and how to have it again:", "", *_worst(rows, posed)]
    lines += ["", NOTE, f"Draws thrown away (unfit and undoable, for so many tasks): {redrawn(posed)}."]
    if crashed:
        lines.append(f"{len(crashed)} runs crashed.")
    return "\n".join(lines) + "\n"


def _scenes(rows: Sequence[Row], text: Callable[[Cell], str]) -> list[str]:
    """A line a method, a column a scene."""
    scenes = list(dict.fromkeys(row.scene for row in rows))
    lines = ["| method | " + " | ".join(scenes) + " |", "|" + "---|" * (1 + len(scenes))]
    cells = cells_by(rows, lambda row: (row.method, row.scene))
    for method in dict.fromkeys(row.method for row in rows):
        found = [cells.get((method, scene)) for scene in scenes]
        lines.append(f"| {method} | " + " | ".join("–" if c is None else text(c) for c in found) + " |")
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
            method, name, c.runs, c.safe, f"{100 * (1 - c.safe_low):.2f}", c.could_evade, c.run_over, c.successes,
            "–" if c.time is None else f"{c.time:.2f}", millimetres(c.least), millimetres(c.least_tool),
            millimetres(c.rtt),
        )  # fmt: skip
        lines.append("| " + " | ".join(map(str, figures)) + " |")
    return lines


def _worst(rows: Sequence[Row], posed: Sequence[Posed]) -> list[str]:
    seed = posed[0].seed if posed else 0
    lines = []
    for method, cell in cells_by(rows, lambda row: row.method).items():
        worst = cell.worst
        if worst is None or not worst.violations:
            lines.append(f"- {method}: none in {cell.runs} runs")
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
        str(cell.could_evade),
        millimetres(cell.depth) if cell.violations else "–",
        millimetres(cell.least),
        "–" if cell.time is None else f"{cell.time:.2f}",
        f"{cell.stops:.1f}",
    )


def _long(c: Cell) -> list[str]:
    def rate(share: float | None, low: float, high: float) -> str:
        return f"{percent(share)} ({100 * low:.1f}–{100 * high:.1f})"

    def plain(value: float | None, digits: int = 2) -> str:
        return "–" if value is None else f"{value:.{digits}f}"

    return [
        str(c.runs),
        rate(c.safe_rate, c.safe_low, c.safe_high),
        rate(c.success_rate, c.success_low, c.success_high),
        str(c.violations),
        str(c.evadable),
        str(c.run_over),
        millimetres(c.depth) if c.violations else "–",
        millimetres(c.least),
        plain(c.time),
        plain(c.path),
        f"{100 * c.filtered:.0f}",
        f"{100 * c.guarded:.0f}",
        plain(c.stops, 1),
        plain(c.smoothness),
    ]
