"""What happened, along the time axis: bands behind every chart, and a strip with a row for each kind."""

from collections.abc import Sequence
from html import escape

from farhand.foxglove.happenings import Happening
from farhand.report.drawing.svg import INNER, LEFT, RIGHT, WIDTH
from farhand.report.reading.story import Story
from farhand.report.reading.stretches import Stretch

KINDS = {
    "filter": "the filter on the operator's side",
    "guard": "the guard on the robot",
    "stop": "stops of the robot",
    "hold": "standing for want of something",
    "stuck": "no progress",
    "refused": "refusals",
    "scene": "changes of the scene",
}
ROW, LEAST = 14.0, 1.2
MOST_LINKS = 400
"""Above so many the strip has bands alone."""
Bands = dict[str, list[tuple[float, float]]]


def bands(story: Story, span: tuple[float, float]) -> Bands:
    """(from, to) in px of each kind; those that touch are one."""
    found: Bands = {}
    for each in story.happenings:
        begin, end = _place(story, each, span)
        rows = found.setdefault(each.kind, [])
        if rows and begin <= rows[-1][1]:
            rows[-1] = rows[-1][0], max(end, rows[-1][1])
        else:
            rows.append((begin, end))
    return found


def definition(name: str, found: Bands) -> str:
    """The bands as a drawing of height 1 that charts use."""
    paths = "".join(
        f'<path class="band {kind}" d="{"".join(f"M{a:.1f} 0H{b:.1f}V1H{a:.1f}Z" for a, b in found[kind])}"/>'
        for kind in KINDS
        if kind in found
    )
    return f'<svg class="defs" aria-hidden="true"><defs><g id="{name}">{paths}</g></defs></svg>'


def strip(story: Story, span: tuple[float, float], prefix: str, told: Sequence[Stretch]) -> str:
    """A row for each kind; what is in the table is a link to its line.

    Args:
        story: of the run.
        span: of time (s).
        prefix: of the lines' ids.
        told: what is in the table.
    """
    shown = [kind for kind in KINDS if any(each.kind == kind for each in story.happenings)]
    if not shown:
        return ""
    height = ROW * len(shown) + 2
    out = [
        f'<svg class="chart strip" viewBox="0 0 {WIDTH:.0f} {height:.0f}" role="img" aria-label="what happened">'
    ]
    found = bands(story, span)
    for row, kind in enumerate(shown):
        y = 1 + row * ROW
        out.append(f'<path class="grid" d="M{LEFT:g} {y + ROW - 1:g}H{WIDTH - RIGHT:g}"/>')
        out.append(f'<text class="tick" x="{LEFT - 6:g}" y="{y + 10:g}" text-anchor="end">{kind}</text>')
        data = "".join(f"M{a:.1f} {y + 1:g}H{b:.1f}v{ROW - 4:g}H{a:.1f}Z" for a, b in found[kind])
        out.append(f'<path class="mark {kind}" d="{data}"/>')
    if len(told) <= MOST_LINKS:
        for each in told:
            if each.kind in shown:
                begin, end = _at(each.begin, each.end, span)
                y = 1 + shown.index(each.kind) * ROW
                out.append(
                    f'<a href="#{prefix}{each.number + 1}"><rect class="hit" x="{begin:.1f}" y="{y:g}" '
                    f'width="{end - begin:.1f}" height="{ROW:g}"><title>{escape(chr(10).join(each.lines))}</title>'
                    "</rect></a>"
                )
    out.append("</svg>")
    return "".join(out)


def _place(story: Story, each: Happening, span: tuple[float, float]) -> tuple[float, float]:
    return _at(story.since(each.began_ns), story.since(each.seen_ns), span)


def _at(begin: float, end: float, span: tuple[float, float]) -> tuple[float, float]:
    """(from, to) of a time in px."""
    length = max(span[1] - span[0], 1e-9)
    left, right = (LEFT + min(1.0, max(0.0, (at - span[0]) / length)) * INNER for at in (begin, end))
    return left, max(right, left + LEAST)
