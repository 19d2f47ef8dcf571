"""The leaderboard's figures: what safety costs, and how near it came."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from farhand.runs.figure import STYLE, save
from farhand.trials.leaderboard.plan.rows import Row
from farhand.trials.leaderboard.telling.cells import Cell, cells_by
from farhand.trials.leaderboard.telling.labels import Point, label_points

ACCENT, GREY = "#0063a8", "#7a8490"
FARHANDS = ("ours", "guard", "both")
D_MIN_MM = 10.0
SHOWN_MM, SPARE_MM = (-250.0, 400.0), 20.0
"""What is shown at least; and beside a run that lies beyond."""
SANS: dict[Any, Any] = {
    "font.family": "sans-serif",
    "font.sans-serif": ["Liberation Sans", "Arial", "DejaVu Sans"],
}
"""As on the page, where these figures are."""


def draw_figures(rows: Sequence[Row], folder: Path) -> list[Path]:
    """Write `trade` and `clearance`, each as SVG, PNG and PDF; returns the PNGs. Of the first operator alone."""
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    if all(row.error for row in rows):
        return []
    own = [row for row in rows if row.operator == rows[0].operator]
    good = [row for row in own if not row.error]
    written = []
    with plt.rc_context({**STYLE, **SANS, "svg.hashsalt": "farhand"}):
        for name, figure in (("trade", _trade(plt, own)), ("clearance", _clearance(plt, good))):
            figure.axes[0].set_title(f"operator: {own[0].operator}", loc="right", fontsize=8)
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
    cells = cells_by(rows, lambda row: row.method).items()
    points = [Point(m, _colour(m), c.time, *_unsafe(c)) for m, c in cells if c.time is not None]
    for point in points:
        bar = [[point.y - point.low], [point.high - point.y]]
        axes.errorbar(point.x, point.y, yerr=bar, fmt="o", ms=5, lw=1, color=point.colour, capsize=2)
    axes.set_ylim(-7.0, 107.0)
    axes.set_xlabel("time over the ideal operator's (median of the runs that finished)")
    axes.set_ylabel("runs that were not safe, % (bars: 95 % interval)")
    axes.margins(x=0.15)
    if points:
        label_points(figure, axes, points)
    else:
        axes.text(0.5, 0.5, "no run finished", transform=axes.transAxes, ha="center")
    return figure


def _unsafe(cell: Cell) -> tuple[float, float, float]:
    share = 100.0 * (1.0 - (cell.safe_rate or 0.0))
    return share, 100.0 * (1.0 - cell.safe_high), 100.0 * (1.0 - cell.safe_low)


def _clearance(plt: Any, rows: Sequence[Row]) -> Any:
    """Boxes of the smallest clearance of each run, and each run beyond the whiskers."""
    methods = list(dict.fromkeys(row.method for row in rows))
    figure, axes = plt.subplots(figsize=(6.2, 4.0), layout="constrained")
    for place, method in enumerate(methods, 1):
        own = [1e3 * r.min_clearance for r in rows if r.method == method and r.min_clearance is not None]
        if not own:
            continue
        low, begin, middle, end, high = np.percentile(own, (1, 25, 50, 75, 99))
        colour = _colour(method)
        axes.hlines(place, low, high, color=colour, lw=1)
        axes.barh(place, end - begin, 0.6, begin, color=colour, alpha=0.35)
        axes.vlines(middle, place - 0.3, place + 0.3, color=colour, lw=1.6)
        beyond = [value for value in own if not low <= value <= high]
        axes.plot(beyond, [place] * len(beyond), "o", ms=2, color=colour)
    axes.axvline(D_MIN_MM, color="black", lw=0.8, ls="--")
    above = axes.get_xaxis_transform()
    axes.annotate("d_min", (D_MIN_MM, 1.0), (4, 2), above, "offset points", fontsize=8)
    axes.set_yticks(range(1, len(methods) + 1), methods)
    axes.set_ylim(len(methods) + 0.5, 0.5)
    least, most = (
        at(1e3 * r.min_clearance for r in rows if r.min_clearance is not None) for at in (min, max)
    )
    axes.set_xlim(min(SHOWN_MM[0], least - SPARE_MM), max(SHOWN_MM[1], most + SPARE_MM))
    axes.set_xlabel("smallest clearance of a run (mm); boxes hold half, lines 98 %")
    return figure
