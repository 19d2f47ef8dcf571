"""How much larger than its body a capsule is."""

from collections.abc import Sequence

import numpy as np

from farhand.common.geometry import Array
from farhand.common.shapes.hull import Hull, NoHullError, hull_of
from farhand.robot_side.arm.fitting.body import Body
from farhand.robot_side.arm.fitting.fit import Capsule

_SAMPLES = 1000
THIN = 1e-4
"""What a sheet is thickened by (m)."""


def excess(capsule: Capsule, others: Sequence[Capsule], body: Body) -> Array:
    """Distances of points spread over a capsule's surface from a body's convex hull (m).

    Args:
        capsule: of the body, or of a piece of it.
        others: of the other pieces; what lies within them is no surface.
        body: the whole.
    """
    points = surface(capsule, _SAMPLES)
    for other in others:
        points = points[other.distances(points) > other.radius]
    hull = _hull(body)
    return np.array([max(hull.distance(*point), 0.0) for point in points.tolist()])


def surface(capsule: Capsule, count: int) -> Array:
    """(m, 3) points spread evenly over a capsule's surface."""
    along = capsule.b - capsule.a
    length = float(np.linalg.norm(along))
    axis = along / length if length > 0.0 else np.array([0.0, 0.0, 1.0])
    across = np.linalg.svd(axis[None, :])[2]
    # Areas of spheres and of tubes are proportional to height alike: even steps of height, golden angles.
    total = length + 2.0 * capsule.radius
    heights = (np.arange(count) + 0.5) / count * total - capsule.radius
    beyond = np.where(heights < 0.0, heights, np.maximum(heights - length, 0.0))
    radii = np.sqrt(np.maximum(capsule.radius**2 - beyond**2, 0.0))
    angles = np.pi * (1.0 + 5.0**0.5) * np.arange(count)
    rims = radii[:, None] * (np.cos(angles)[:, None] * across[1] + np.sin(angles)[:, None] * across[2])
    points: Array = capsule.a + heights[:, None] * axis + rims
    return points


def _hull(body: Body) -> Hull:
    around = [
        surface(Capsule(p, p, r), 200) if r > 0.0 else p[None]
        for p, r in zip(body.points, body.radii, strict=True)
    ]
    points = np.concatenate(around)
    try:
        return hull_of(points)
    except NoHullError:  # a sheet
        thick = THIN * np.concatenate([np.eye(3), -np.eye(3)])
        return hull_of((points[:, None] + thick).reshape(-1, 3))
