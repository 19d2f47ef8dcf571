"""Names beside the points of a figure, where they lie neither on each other nor on what is drawn."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

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


@dataclass(frozen=True)
class Point:
    """Attributes:
    name, colour: of its label.
    x, y: where it is (units of the axes).
    low, high: ends of its bar, in y.
    """

    name: str
    colour: str
    x: float
    y: float
    low: float
    high: float


def label_points(figure: Any, axes: Any, points: Sequence[Point]) -> None:
    """Write the name of each point beside it; the limits of the axes stand already."""
    from matplotlib.text import Text

    figure.draw_without_rendering()  # only now is it known where on the figure a point is
    point_px = figure.dpi / 72.0
    frame = Box(*axes.get_window_extent().extents)
    taken = [box for point in points for box in _drawn(axes, point, point_px)]
    for point in points:
        label = axes.annotate(
            point.name, (point.x, point.y), (0, 0), textcoords="offset points", color=point.colour, ha="center",
            va="center",
            arrowprops={"arrowstyle": "-", "color": point.colour, "lw": 0.5, "shrinkA": 0, "shrinkB": 3},
        )  # fmt: skip
        label.set_in_layout(False)  # else the axes would give way to it, and all move
        extent = Text.get_window_extent(label)  # without its line
        x, y = axes.transData.transform((point.x, point.y))
        box = _free(x, y, (extent.width / 2.0, extent.height / 2.0), point_px, frame, taken)
        taken.append(box)
        label.set_position(((box.centre[0] - x) / point_px, (box.centre[1] - y) / point_px))
        label.arrow_patch.set_visible(box.distance(x, y) > LEADER_PT * point_px)


def _drawn(axes: Any, point: Point, point_px: float) -> tuple[Box, Box]:
    """What a point and its bar cover."""
    (x, y), (_, bottom), (_, top) = (
        axes.transData.transform((point.x, at)) for at in (point.y, point.low, point.high)
    )
    half = BAR_PT * point_px
    return Box.around(x, y, MARK_PT * point_px, MARK_PT * point_px), Box(x - half, bottom, x + half, top)


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
