"""The path in space: seen from above and from the sides as drawings, and as numbers for the one that turns."""

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from farhand.common.geometry import Array
from farhand.common.shapes.obstacle import Obstacle
from farhand.common.shapes.plane import Plane
from farhand.common.shapes.pose import rotation
from farhand.report.drawing.svg import joined, ticks_of
from farhand.report.drawing.thinning import thinned
from farhand.report.reading.figures import limit_of
from farhand.report.reading.story import Story
from farhand.runs.scene_drawing import image, outline

VIEWS: tuple[tuple[str, tuple[int, int]], ...] = (
    ("from above: x and y", (0, 1)),
    ("from the front: x and z", (0, 2)),
    ("from the side: y and z", (1, 2)),
)
AXES = "xyz"
SIDE = 360.0
PATH_STRETCHES = 700
APART = 0.5
"""States farther apart than this are not joined (s)."""

Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class Space:
    """Attributes:
    path: (n, 3) of the tool, thinned (m).
    begins: (n,) where the path begins anew.
    near: (n,) where the clearance was under the limit.
    nearest: row of the least clearance; None: there is no path, or no clearance.
    obstacles, targets: as they were told of last.
    around: radius of the tool's sphere (m), and of the limit around it.
    """

    path: Array
    begins: Flags
    near: Flags
    nearest: int | None
    obstacles: Sequence[Obstacle]
    targets: Sequence[tuple[float, float, float]]
    around: tuple[float, float]
    changes: int = 0

    @property
    def corners(self) -> Array:
        """(2, 3) of a box around all that is to be seen (m)."""
        points = [self.path, np.asarray(self.targets, dtype=float).reshape(-1, 3)]
        for each in self.obstacles:
            if not isinstance(each.shape, Plane):
                reach = each.shape.bounding_radius + sum(self.around)
                points.append(np.array(each.position)[None] + np.array([[-reach] * 3, [reach] * 3]))
        every = np.vstack(points)
        if not len(every):
            return np.array([[0.0] * 3, [1.0] * 3])
        pad = max(0.05 * float(np.ptp(every, axis=0).max()), 0.02)
        return np.array([every.min(axis=0) - pad, every.max(axis=0) + pad])


def space_of(story: Story) -> Space:
    """What there is to be drawn of a run."""
    states, limit = story.states, limit_of(story) or 0.0
    session, sample = states["session"], states["sample"]
    order = np.lexsort((sample, session))
    places = np.column_stack([states[axis] for axis in AXES])[order].reshape(-1, 3)
    at, clearance = sample[order], states["clearance"][order]
    number = np.arange(len(order), dtype=float)
    rows = thinned(number, np.nan_to_num(clearance), (0.0, float(len(order))), PATH_STRETCHES)
    near = clearance < limit
    scene = story.scene
    obstacles = scene.obstacles if scene is not None else ()
    apart = np.diff(at, prepend=at[:1]) > APART
    new = apart | (np.diff(session[order], prepend=session[order][:1]) != 0.0)
    begun = np.cumsum(new)[rows]
    return Space(
        path=places[rows],
        begins=np.diff(begun, prepend=begun[:1]) > 0,
        near=near[rows],
        nearest=int(clearance[rows].argmin()) if len(rows) and story.had_obstacles else None,
        changes=story.scene_changes,
        obstacles=obstacles,
        targets=scene.targets if scene is not None else (),
        around=((story.robot.radius if story.robot is not None else 0.0), limit),
    )


def seen(space: Space, axes: tuple[int, int], corners: Array, name: str) -> str:
    """The path as a drawing, the two axes to the same scale; `corners` of all that is shown (m)."""
    a, b = axes
    (low_a, low_b), (high_a, high_b) = corners[:, [a, b]].tolist()
    scale = SIDE / max(high_a - low_a, high_b - low_b)
    width, height = (high_a - low_a) * scale, (high_b - low_b) * scale

    def points(places: Array) -> tuple[Array, Array]:
        return (places[:, 0] - low_a) * scale, height - (places[:, 1] - low_b) * scale

    out = [
        f'<svg class="view" viewBox="-34 -18 {width + 44:.0f} {height + 52:.0f}" role="img" '
        f'aria-label="path of the tool, {escape(name)}">'
    ]
    out.append(f'<svg x="0" y="0" width="{width:.0f}" height="{height:.0f}">')
    for grown, look in ((sum(space.around), "keep"), (0.0, "obstacle")):
        for each in space.obstacles:
            if not isinstance(each.shape, Plane):
                ring = outline(each, axes, grown)[::5]
                out.append(
                    f'<path class="{look}" d="{joined(*points(ring))}Z"><title>{escape(each.id)}</title></path>'
                )
    for each in space.obstacles:
        if each.path:
            out.append(f'<path class="way" d="{joined(*points(np.array(each.path)[:, [a, b]]))}"/>')
    out += _planes(space, axes, points)
    x, y = points(space.path[:, [a, b]])
    out.append(f'<path class="tool" d="{joined(x, y, space.begins.tolist())}"/>')
    if space.near.any():
        dots = "".join(f"M{p:.1f} {q:.1f}h.1" for p, q in zip(x[space.near], y[space.near], strict=True))
        out.append(f'<path class="near" d="{dots}"/>')
    out += _places(space, axes, points)
    out.append("</svg>")
    out.append(f'<rect class="frame" x="0" y="0" width="{width:.0f}" height="{height:.0f}"/>')
    out += _scale(corners[:, [a, b]], scale, height, (AXES[a], AXES[b]))
    out.append("</svg>")
    return "".join(out)


def for_turning(space: Space, corners: Array) -> dict[str, Any]:
    """What the canvas draws: numbers to a tenth of a millimetre."""
    path: list[list[float] | None] = []
    for place, begins in zip(space.path.round(4).tolist(), space.begins.tolist(), strict=True):
        path += [None, place] if begins else [place]
    bodies = []
    for each in space.obstacles:
        if isinstance(each.shape, Plane):
            continue
        corner, radius = _hull(each)
        bodies.append({"points": corner.round(4).tolist(), "radius": round(radius, 4)})
    return {
        "box": corners.round(4).tolist(),
        "path": path,
        "near": space.path[space.near].round(4).tolist()[:500],
        "nearest": None if space.nearest is None else space.path[space.nearest].round(4).tolist(),
        "targets": [[round(value, 4) for value in target] for target in space.targets],
        "bodies": bodies,
        "around": round(sum(space.around), 4),
    }


def hidden_planes(space: Space, axes: tuple[int, int] | None = None) -> list[str]:
    """Planes that a view does not show; without axes those that are in the scene."""
    planes = [each for each in space.obstacles if isinstance(each.shape, Plane)]
    return [each.id for each in planes if axes is None or _edge(each, axes) is None]


def _hull(each: Obstacle) -> tuple[Array, float]:
    """(k, 3) points and a radius: the shape is all within that radius of the points' hull."""
    flat, radius = image(each, (0, 1))
    high, _ = image(each, (2, 2))
    return np.column_stack([flat, high[:, 0]]), radius


def _planes(space: Space, axes: tuple[int, int], points: Any) -> list[str]:
    out = []
    for each in space.obstacles:
        edge = _edge(each, axes) if isinstance(each.shape, Plane) else None
        if edge is not None:
            x, y = points(edge)
            out.append(f'<path class="obstacle" d="{joined(x, y)}"><title>{escape(each.id)}</title></path>')
    return out


def _edge(each: Obstacle, axes: tuple[int, int]) -> Array | None:
    """(2, 2) two points far away on a plane's edge; None of one that is not seen from the side."""
    normal = np.array(rotation(each.orientation))[:, 2][list(axes)]
    if abs(float(normal @ normal) - 1.0) > 1e-6:
        return None
    along = np.array([-normal[1], normal[0]]) * 1e3
    place = np.array(each.position)[list(axes)]
    return np.array([place - along, place + along])


def _places(space: Space, axes: tuple[int, int], points: Any) -> list[str]:
    a, b = axes
    out = []
    numbers: dict[tuple[str, str], list[str]] = {}
    for number, target in enumerate(space.targets, 1):
        x, y = points(np.array([[target[a], target[b]]]))
        numbers.setdefault((f"{x[0]:.1f}", f"{y[0]:.1f}"), []).append(str(number))
    for (px, py), who in numbers.items():
        out.append(f'<circle class="target" cx="{px}" cy="{py}" r="5"/>')
        label = ", ".join(who[:3]) + (" …" if len(who) > 3 else "")
        out.append(f'<text class="tick" x="{float(px) + 8:.1f}" y="{float(py) - 6:.1f}">{label}</text>')
    if len(space.path):  # around what may lie there
        x, y = points(space.path[:1, [a, b]])
        out.append(f'<rect class="start" x="{x[0] - 7:.1f}" y="{y[0] - 7:.1f}" width="14" height="14"/>')
    if space.nearest is not None:
        x, y = points(space.path[[space.nearest]][:, [a, b]])
        out.append(f'<circle class="nearest" cx="{x[0]:.1f}" cy="{y[0]:.1f}" r="8"/>')
    return out


def _scale(corners: Array, scale: float, height: float, names: tuple[str, str]) -> list[str]:
    (low_a, low_b), (high_a, high_b) = corners.tolist()
    out = []
    for value in ticks_of(low_a, high_a, _ticks((high_a - low_a) * scale)):
        x = (value - low_a) * scale
        out.append(
            f'<text class="tick" x="{x:.1f}" y="{height + 14:.0f}" text-anchor="middle">{value:g}</text>'
        )
    for value in ticks_of(low_b, high_b, _ticks(height)):
        y = height - (value - low_b) * scale
        out.append(f'<text class="tick" x="-5" y="{y + 4:.1f}" text-anchor="end">{value:g}</text>')
    middle = (high_a - low_a) * scale / 2
    out.append(
        f'<text class="unit" x="{middle:.0f}" y="{height + 30:.0f}" text-anchor="middle">{names[0]} (m)</text>'
    )
    out.append(f'<text class="unit" x="-30" y="-8">{names[1]} (m)</text>')
    return out


def _ticks(length: float) -> int:
    """How many numbers find a place along an axis (px)."""
    return max(2, round(length / 55))
