"""Obstacles in a figure: the outlines that shapes of any kind have when seen along an axis.

Every shape but a plane is all that lies within a radius of the hull of some points: seen along an axis it is all that
lies within that radius of the hull of the points' images, and a limit around it has a larger radius. A plane is drawn
where it is seen from the side; of one that is not, a line says so.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from farhand.common.geometry import Array, to_vector3
from farhand.common.messages.scene import Obstacle
from farhand.common.shapes.box import Box
from farhand.common.shapes.capsule import Capsule
from farhand.common.shapes.cover import plane_of
from farhand.common.shapes.distance import distance_to
from farhand.common.shapes.mesh import Mesh
from farhand.common.shapes.obstacle import moved
from farhand.common.shapes.plane import Plane
from farhand.common.shapes.pose import rotation
from farhand.common.shapes.sphere import Sphere

Axes2 = tuple[int, int]

_TURN = np.linspace(0.0, 2.0 * np.pi, 361)[:-1]
_ROUND = np.column_stack([np.cos(_TURN), np.sin(_TURN)])
_FAR = 1e3  # m; beyond every picture
_EDGE_ON = 1e-6
WAY = {"color": "#666666", "lw": 0.8, "ls": (0, (4, 2))}


def image(obstacle: Obstacle, axes: Axes2) -> tuple[Array, float]:
    """(k, 2) points and a radius: what is seen is all within that radius of the points' hull (m); not of planes."""
    shape = obstacle.shape
    points, radius = np.zeros((1, 3)), 0.0
    if isinstance(shape, Sphere):
        radius = shape.radius
    elif isinstance(shape, Capsule):
        points, radius = np.outer([-1.0, 1.0], [0.0, 0.0, shape.half_length]), shape.radius
    elif isinstance(shape, Box):
        signs = np.array(np.meshgrid(*[[-1.0, 1.0]] * 3)).reshape(3, -1).T
        points = signs * np.array(shape.half_extents)
    elif isinstance(shape, Mesh):
        points = shape.points
    placed = points @ np.array(rotation(obstacle.orientation)).T + np.array(obstacle.position)
    return placed[:, list(axes)], radius


def outline(obstacle: Obstacle, axes: Axes2, grown: float = 0.0) -> Array:
    """(m, 2) polygon around all that is seen of a shape, and `grown` m more; not of planes."""
    points, radius = image(obstacle, axes)
    return np.asarray(points[(points @ _ROUND.T).argmax(axis=0)] + (radius + grown) * _ROUND)


def seen_inside(obstacle: Obstacle, axes: Axes2, places: Array, grown: float) -> Array:
    """(n,) whether points (n, 3) are seen inside a shape's outline, `grown` m larger, though farther away in space.

    Inside a plane's outline is nothing that is not too near in space as well.
    """
    inside = np.zeros(len(places), dtype=bool)
    if isinstance(obstacle.shape, Plane):
        return inside
    points, radius = image(obstacle, axes)
    over = (places[:, list(axes)] @ _ROUND.T - (points @ _ROUND.T).max(axis=0)).max(axis=1)
    for index in np.flatnonzero(over < radius + grown):
        inside[index] = distance_to(obstacle, to_vector3(places[index])) >= grown
    return inside


def draw_shapes(
    axes: Any, obstacles: Sequence[Obstacle], plane: Axes2, rings: Sequence[tuple[float, str, dict[str, Any]]]
) -> list[str]:
    """Draw each obstacle with rings around it; returns the ids of planes that cannot be seen.

    Args:
        axes: of matplotlib.
        obstacles: where they shall be drawn.
        plane: the axes of the base frame that are seen.
        rings: distance from the surface (m), label and style; labelled once.
    """
    from matplotlib.patches import Circle, Polygon

    hidden: list[str] = []
    labelled = False
    for obstacle in obstacles:
        if isinstance(obstacle.shape, Plane) and _slope(obstacle, plane) is None:
            hidden.append(obstacle.id)
            continue
        for grown, label, style in rings:
            how = style | ({} if labelled else {"label": label})
            if isinstance(obstacle.shape, Plane):
                # An artist, not a patch: what has no end must not widen the picture.
                axes.add_artist(Polygon(_half_plane(obstacle, plane, grown), **how))
            elif isinstance(obstacle.shape, Sphere):
                centre = obstacle.position[plane[0]], obstacle.position[plane[1]]
                axes.add_patch(Circle(centre, obstacle.shape.radius + grown, **how))
            else:
                axes.add_patch(Polygon(outline(obstacle, plane, grown), **how))
        labelled = True
    return hidden


def draw_ways(axes: Any, obstacles: Sequence[Obstacle], plane: Axes2, duration: float) -> None:
    """A line for what moves: the path of a shuttle, and the way of what goes straight on for `duration` s."""
    labelled = False
    for obstacle in obstacles:
        if not obstacle.moves:
            continue
        ends = obstacle.path or (obstacle.position, moved(obstacle, duration).position)
        way = np.array(ends)[:, list(plane)]
        axes.plot(*way.T, label=None if labelled else "way of what moves", **WAY)
        labelled = True


def _slope(obstacle: Obstacle, axes: Axes2) -> Array | None:
    """(2,) the normal of a plane that is seen from the side; None of one that is not."""
    found = plane_of(obstacle)
    if found is None:
        return None
    normal = found[0][list(axes)]
    return normal if abs(float(normal @ normal) - 1.0) < _EDGE_ON else None


def _half_plane(obstacle: Obstacle, axes: Axes2, grown: float) -> Array:
    normal = _slope(obstacle, axes)
    if normal is None:
        raise ValueError(f"plane {obstacle.id!r} is not seen from the side")
    edge = np.array(obstacle.position)[list(axes)] + grown * normal
    along = np.array([-normal[1], normal[0]])
    return np.array(
        [
            edge - _FAR * along,
            edge + _FAR * along,
            edge + _FAR * (along - normal),
            edge - _FAR * (along + normal),
        ]
    )
