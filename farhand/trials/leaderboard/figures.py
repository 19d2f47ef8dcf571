"""The leaderboard's figures: what safety costs, and how near it came."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from farhand.runs.figure import STYLE, save
from farhand.trials.leaderboard.cells import Cell, cells_by
from farhand.trials.leaderboard.rows import Row

ACCENT, GREY = "#0063a8", "#7a8490"
FARHANDS = ("ours", "guard", "both")
D_MIN_MM = 10.0
SHOWN_MM = (-250.0, 400.0)


def draw_figures(rows: Sequence[Row], folder: Path) -> list[Path]:
    """Write `trade` and `clearance`, each as SVG, PNG and PDF; returns the PNGs. Of the first operator alone."""
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    good = [row for row in rows if not row.error]
    if not good:
        return []
    own = [row for row in good if row.operator == good[0].operator]
    written = []
    with plt.rc_context({**STYLE, "svg.hashsalt": "farhand"}):
        for name, figure in (("trade", _trade(plt, own)), ("clearance", _clearance(plt, own))):
            png = folder / f"{name}.png"
            save(figure, png, dpi=200)
            for ending in ("pdf", "svg"):
                save(figure, folder / f"{name}.{ending}")
            plt.close(figure)
            written.append(png)
    return written


def _colour(method: str) -> str:
    return ACCENT if method in FARHANDS else GREY


def _trade(plt: Any, rows: Sequence[Row]) -> Any:
    """Runs that were not safe with their interval, over time against the ideal's."""
    figure, axes = plt.subplots(figsize=(6.2, 4.0), layout="constrained")
    cells = {m: c for m, c in cells_by(rows, lambda row: row.method).items() if c.time is not None and c.runs}
    for place, (method, cell) in enumerate(sorted(cells.items(), key=lambda each: each[1].time or 0.0)):
        unsafe, low, high = _unsafe(cell)
        axes.errorbar(
            cell.time,
            unsafe,
            yerr=[[unsafe - low], [high - unsafe]],
            fmt="o",
            ms=5,
            lw=1,
            color=_colour(method),
            capsize=2,
        )
        above = 9 if place % 2 == 0 else -14
        axes.annotate(
            method, (cell.time, unsafe), xytext=(6, above), textcoords="offset points", color=_colour(method)
        )
    axes.set_ylim(-2.0, 102.0)
    axes.set_xlabel("time over the ideal operator's (median of the runs that finished)")
    axes.set_ylabel("runs that were not safe (%), 95 %")
    axes.margins(x=0.15)
    return figure


def _unsafe(cell: Cell) -> tuple[float, float, float]:
    share = 100.0 * (1.0 - (cell.safe_rate or 0.0))
    return share, 100.0 * (1.0 - cell.safe_high), 100.0 * (1.0 - cell.safe_low)


def _clearance(plt: Any, rows: Sequence[Row]) -> Any:
    """Boxes of the smallest clearance of each run, and each run beyond the whiskers."""
    methods = list(dict.fromkeys(row.method for row in rows))
    figure, axes = plt.subplots(figsize=(6.2, 4.0), layout="constrained")
    values = [
        [1e3 * row.min_clearance for row in rows if row.method == m and row.min_clearance is not None]
        for m in methods
    ]
    drawn = axes.boxplot(
        values, vert=False, widths=0.6, whis=(1, 99), patch_artist=True, flierprops={"ms": 2}
    )
    for method, box, median in zip(methods, drawn["boxes"], drawn["medians"], strict=True):
        box.set(facecolor=_colour(method), alpha=0.35, edgecolor=_colour(method))
        median.set(color=_colour(method), lw=1.6)
    axes.axvline(D_MIN_MM, color="black", lw=0.8, ls="--")
    axes.annotate("d_min", (D_MIN_MM, 0.5), xytext=(4, 2), textcoords="offset points", fontsize=8)
    axes.set_yticks(range(1, len(methods) + 1), methods)
    axes.invert_yaxis()
    axes.set_xlim(*SHOWN_MM)
    axes.set_xlabel("smallest clearance of a run (mm); boxes hold half, whiskers 98 %")
    return figure
