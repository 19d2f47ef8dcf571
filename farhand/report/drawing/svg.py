"""Charts over time as SVG text: axes, lines, stacked areas, limits. Colours come from the page's style sheet."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape

import numpy as np

from farhand.common.geometry import Array
from farhand.report.drawing.thinning import highest, thinned

WIDTH, LEFT, RIGHT, TOP, BOTTOM = 760.0, 46.0, 10.0, 18.0, 20.0
INNER = WIDTH - LEFT - RIGHT


@dataclass(frozen=True, slots=True)
class Line:
    """Attributes:
    label: for the legend.
    look: class of the style sheet.
    t, values: (n,) s and the chart's unit; NaN where unknown.
    gap: points farther apart than this are not joined (s).
    """

    label: str
    look: str
    t: Array
    values: Array
    gap: float = math.inf


@dataclass(frozen=True, slots=True)
class Level:
    """A line across the chart, such as a limit."""

    label: str
    look: str
    value: float


@dataclass(frozen=True)
class Chart:
    """Attributes:
    unit: of the vertical axis.
    lines, levels: what is drawn, the later above the earlier.
    stack: areas on top of one another, the first at the bottom; all at the same instants.
    height: of the drawing (px).
    top: largest value that is shown; None: all.
    marks: id of the drawing of what happened, which lies behind.
    name: what it shows, for those who cannot see it.
    """

    unit: str
    lines: Sequence[Line] = ()
    levels: Sequence[Level] = ()
    stack: Sequence[Line] = ()
    height: float = 190.0
    top: float | None = None
    marks: str = ""
    name: str = ""

    def range(self) -> tuple[float, float]:
        """Least and largest value, zero included; (0, 1) where nothing is known."""
        found = [0.0, *(level.value for level in self.levels)]
        for line in self.lines:
            known = line.values[np.isfinite(line.values)]
            if len(known):
                found += [float(known.min()), float(known.max())]
        if self.stack and len(self.stack[0].t):
            found.append(float(np.sum([np.nan_to_num(each.values) for each in self.stack], axis=0).max()))
        low, high = min(found), max(found)
        if self.top is not None:
            high = min(high, self.top)
        return low, high if high > low else low + 1.0


@dataclass(frozen=True, slots=True)
class Frame:
    """Where time and values lie in a drawing.

    Attributes:
        span: of time (s).
        low, high: of the values.
        height: of the whole drawing (px).
    """

    span: tuple[float, float]
    low: float
    high: float
    height: float

    def x(self, t: Array) -> Array:
        """(n,) px."""
        begin, end = self.span
        return LEFT + (t - begin) / max(end - begin, 1e-9) * INNER

    def y(self, values: Array) -> Array:
        """(n,) px; what lies beyond the range is drawn at its edge."""
        inner = self.height - TOP - BOTTOM
        share = (np.clip(values, self.low, self.high) - self.low) / (self.high - self.low)
        return self.height - BOTTOM - share * inner


def ticks_of(low: float, high: float, wanted: int) -> list[float]:
    """Round values across a range, some `wanted` of them."""
    step = 10.0 ** math.floor(math.log10(max(high - low, 1e-12) / wanted))
    step = next((step * k for k in (1, 2, 5) if (high - low) / (step * k) <= wanted), step * 10)
    first = math.ceil(low / step - 1e-9)
    count = math.floor(high / step + 1e-9) - first + 1
    return [(first + k) * step + 0.0 for k in range(count)]


def drawn(chart: Chart, span: tuple[float, float], limits: tuple[float, float]) -> str:
    """A chart as an SVG element; `limits` are the least and the largest value of its axis."""
    frame = Frame(span, *limits, chart.height)
    out = [
        f'<svg class="chart" viewBox="0 0 {WIDTH:.0f} {chart.height:.0f}" role="img" '
        f'aria-label="{escape(chart.name)}">'
    ]
    if chart.marks:
        tall = chart.height - TOP - BOTTOM
        out.append(f'<use href="#{chart.marks}" transform="translate(0 {TOP:g}) scale(1 {tall:g})"/>')
    out.append(_grid(frame, chart.unit))
    out += _stacked(chart.stack, frame)
    for level in chart.levels:
        if frame.low <= level.value <= frame.high:
            y = float(frame.y(np.array([level.value]))[0])
            out.append(f'<path class="{level.look}" d="M{LEFT:g} {y:.1f}H{WIDTH - RIGHT:g}"/>')
    for line in chart.lines:
        out.append(f'<path class="{line.look}" d="{_path(line, frame)}"/>')
    out.append("</svg>")
    return "".join(out)


def legend(chart: Chart) -> str:
    """What the lines and areas are."""
    keys = [(line.look, line.label) for line in (*chart.lines, *reversed(chart.stack))]
    keys += [(level.look, level.label) for level in chart.levels]
    items = "".join(
        f'<li><svg class="key" viewBox="0 0 18 10" aria-hidden="true"><path class="{look}" '
        f'd="{"M0 0H18V10H0Z" if "area" in look else "M0 5H18"}"/></svg>{escape(label)}</li>'
        for look, label in keys
        if label
    )
    return f'<ul class="legend">{items}</ul>'


def _grid(frame: Frame, unit: str) -> str:
    out = []
    for k, value in enumerate(ticks_of(frame.low, frame.high, 5)):
        between = " between" if k % 2 else ""  # left out where text is large
        y = float(frame.y(np.array([value]))[0])
        out.append(f'<path class="grid" d="M{LEFT:g} {y:.1f}H{WIDTH - RIGHT:g}"/>')
        out.append(
            f'<text class="tick{between}" x="{LEFT - 6:g}" y="{y + 4:.1f}" text-anchor="end">{value:g}</text>'
        )
    bottom = frame.height - BOTTOM
    for value in ticks_of(*frame.span, 8):
        x = float(frame.x(np.array([value]))[0])
        out.append(f'<path class="grid" d="M{x:.1f} {bottom:g}v4"/>')
        out.append(
            f'<text class="tick under" x="{x:.1f}" y="{bottom + 16:g}" text-anchor="middle">{_clock(value)}</text>'
        )
    out.append(f'<text class="tick under" x="{LEFT - 18:g}" y="{bottom + 16:g}" text-anchor="end">s</text>')
    out.append(f'<text class="unit" x="{LEFT - 6:g}" y="9" text-anchor="end">{escape(unit)}</text>')
    out.append(f'<path class="axis" d="M{LEFT:g} {TOP:g}V{bottom:g}H{WIDTH - RIGHT:g}"/>')
    return "".join(out)


def _clock(seconds: float) -> str:
    return f"{seconds:g}"


def _path(line: Line, frame: Frame) -> str:
    rows = thinned(line.t, line.values, frame.span)
    if not len(rows):
        return ""
    apart = (np.diff(line.t, prepend=line.t[:1]) > line.gap) | np.isnan(line.values)
    before = np.cumsum(apart)[rows]  # gaps in the line itself, not those that the thinning makes
    new = np.diff(before, prepend=before[:1]) > 0
    return joined(frame.x(line.t[rows]), frame.y(line.values[rows]), new.tolist())


def joined(x: Array, y: Array, new: Iterable[bool] = ()) -> str:
    """The data of a path through points (px), with a new beginning at those that say so."""
    begins = list(new) or [False] * len(x)
    out, fresh = [], True
    for a, b, begin in zip(x.tolist(), y.tolist(), begins, strict=True):
        out.append(f"{'M' if fresh or begin else 'L'}{a:.1f} {b:.1f}")
        if (fresh or begin) and len(x) == 1:
            out.append("h.1")  # a point alone is seen as well
        fresh = False
    return "".join(out)


def _stacked(stack: Sequence[Line], frame: Frame) -> list[str]:
    if not stack or not len(stack[0].t):
        return []
    t = stack[0].t
    levels = np.cumsum([np.nan_to_num(each.values) for each in stack], axis=0)
    rows = highest(t, levels[-1], frame.span)
    x, below = frame.x(t[rows]), np.full(len(rows), float(frame.y(np.zeros(1))[0]))
    out = []
    for each, level in zip(stack, levels, strict=True):
        above = frame.y(level[rows])
        there = joined(x, above)
        back = joined(x[::-1], below[::-1])
        out.append(f'<path class="{each.look}" d="{there}L{back[1:]}Z"/>')
        below = above
    return out
