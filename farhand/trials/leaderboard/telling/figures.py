"""The leaderboard's figures: what safety costs, and how near it came."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from farhand.runs.figure import STYLE, save
from farhand.trials.leaderboard.plan.rows import Row
from farhand.trials.leaderboard.telling.cells import Cell, cells_by

ACCENT, GREY = "#0063a8", "#7a8490"
FARHANDS = ("ours", "guard", "both")
D_MIN_MM = 10.0
SHOWN_MM = (-250.0, 400.0)
SANS: dict[Any, Any] = {
    "font.family": "sans-serif",
    "font.sans-serif": ["Liberation Sans", "Arial", "DejaVu Sans"],
}
"""As on the page, where these figures are."""
REACHES_PT, DIRECTIONS = (5.0, 10.0, 17.0, 26.0, 38.0, 52.0, 70.0), 16
"""A label is put at the first of these distances, in the first of so many directions, in which it is free."""
LEADER_PT = 9.0
"""A label farther away has a line to its point."""
MARK_PT, BAR_PT = 4.0, 2.5
"""Half of what is kept free around a point, and around its bar."""


@dataclass(frozen=True)
class Box:
    """A rectangle (pixels)."""

    left: float
    bottom: float
    right: float
    top: float

    @staticmethod
    def around(x: float, y: float, half_width: float, half_height: float) -> "Box":
        """By its centre and its size (pixels)."""
        return Box(x - half_width, y - half_height, x + half_width, y + half_height)

    @property
    def centre(self) -> tuple[float, float]:
        """In pixels."""
        return (self.left + self.right) / 2.0, (self.bottom + self.top) / 2.0

    def distance(self, x: float, y: float) -> float:
        """From a point (pixels)."""
        across = max(self.left - x, x - self.right, 0.0)
        return math.hypot(across, max(self.bottom - y, y - self.top, 0.0))

    def meets(self, other: "Box") -> bool:
        """Whether they lie on each other."""
        beside = self.left >= other.right or other.left >= self.right
        return not (beside or self.bottom >= other.top or other.bottom >= self.top)

    def holds(self, other: "Box") -> bool:
        """Whether the other is inside."""
        wide = self.left <= other.left and other.right <= self.right
        return wide and self.bottom <= other.bottom and other.top <= self.top


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
    cells = {m: c for m, c in cells_by(rows, lambda row: row.method).items() if c.time is not None}
    for method, cell in cells.items():
        unsafe, low, high = _unsafe(cell)
        bar = [[unsafe - low], [high - unsafe]]
        axes.errorbar(cell.time, unsafe, yerr=bar, fmt="o", ms=5, lw=1, color=_colour(method), capsize=2)
    axes.set_ylim(-7.0, 107.0)
    axes.set_xlabel("time over the ideal operator's (median of the runs that finished)")
    axes.set_ylabel("runs that were not safe, % (bars: 95 % interval)")
    axes.margins(x=0.15)
    if cells:
        _label(figure, axes, cells)
    else:
        axes.text(0.5, 0.5, "no run finished", transform=axes.transAxes, ha="center")
    return figure


def _label(figure: Any, axes: Any, cells: Mapping[str, Cell]) -> None:
    """Names beside their points, where they lie neither on each other nor on what is drawn."""
    from matplotlib.text import Text

    figure.draw_without_rendering()  # only now is it known where on the figure a point is
    point_px = figure.dpi / 72.0
    frame = Box(*axes.get_window_extent().extents)
    taken: list[Box] = []
    for cell in cells.values():
        unsafe, low, high = _unsafe(cell)
        (x, y), (_, bottom), (_, top) = (
            axes.transData.transform((cell.time, at)) for at in (unsafe, low, high)
        )
        half = BAR_PT * point_px
        taken += [
            Box.around(x, y, MARK_PT * point_px, MARK_PT * point_px),
            Box(x - half, bottom, x + half, top),
        ]
    for method, cell in cells.items():
        point = (cell.time, _unsafe(cell)[0])
        label = axes.annotate(
            method, point, (0, 0), textcoords="offset points", color=_colour(method), ha="center", va="center",
            arrowprops={"arrowstyle": "-", "color": _colour(method), "lw": 0.5, "shrinkA": 0, "shrinkB": 3},
        )  # fmt: skip
        label.set_in_layout(False)  # else the axes would give way to it, and all move
        extent = Text.get_window_extent(label)  # without its line
        x, y = axes.transData.transform(point)
        box = _free(x, y, (extent.width / 2.0, extent.height / 2.0), point_px, frame, taken)
        taken.append(box)
        label.set_position(((box.centre[0] - x) / point_px, (box.centre[1] - y) / point_px))
        label.arrow_patch.set_visible(box.distance(x, y) > LEADER_PT * point_px)


def _free(
    x: float, y: float, half: tuple[float, float], point_px: float, frame: Box, taken: list[Box]
) -> Box:
    """Where a label is put: the nearest place within the frame that is free, or lies on least.

    Args:
        x, y: its point (pixels).
        half: its half width and height (pixels).
        point_px: a typographic point (pixels).
        frame: of the axes.
        taken: what is there.
    """
    places = []
    for reach in REACHES_PT:
        for number in range(DIRECTIONS):
            angle = 2.0 * math.pi * number / DIRECTIONS
            right, up = math.cos(angle), math.sin(angle)
            box = Box.around(
                x + right * (half[0] + reach * point_px), y + up * (half[1] + reach * point_px), *half
            )
            if frame.holds(box):
                places.append(box)
    return min(
        places, key=lambda box: sum(box.meets(other) for other in taken), default=Box.around(x, y, *half)
    )


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
    axes.set_xlim(*SHOWN_MM)
    axes.set_xlabel("smallest clearance of a run (mm); boxes hold half, lines 98 %")
    return figure
