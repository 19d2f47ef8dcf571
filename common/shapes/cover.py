"""What a solver of spheres and planes sees of an obstacle: spheres that cover it, or a plane."""

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from farhand.common.geometry import Array
from farhand.common.shapes.box import Box
from farhand.common.shapes.box_cells import box_spheres
from farhand.common.shapes.capsule import Capsule
from farhand.common.shapes.mesh import Mesh
from farhand.common.shapes.mesh_cells import mesh_spheres
from farhand.common.shapes.obstacle import Obstacle
from farhand.common.shapes.plane import Plane
from farhand.common.shapes.pose import rotation
from farhand.common.shapes.shape import Shape

EXCESS = 0.02
"""By how much a sphere may leave what it covers (m)."""
MAX_SPHERES = 2000
"""What takes more of them than this is refused in scenarios."""
MOST_SPHERES = 4 * MAX_SPHERES
"""Of all shapes together."""


def cover(obstacle: Obstacle) -> tuple[Array, Array]:
    """Spheres that cover all of an obstacle: centres (k, 3) in its own frame and radii (k,) (m).

    They leave it by EXCESS at most; where that takes more than MAX_SPHERES it is one sphere around all of it. A plane
    has none: see `plane_of`.
    """
    shape = obstacle.shape
    if isinstance(shape, Plane):
        return np.zeros((0, 3)), np.zeros(0)
    found = closely_covered(shape)
    return found if found is not None else _one_around(shape)


def covers(obstacles: Sequence[Obstacle]) -> list[tuple[Array, Array]]:
    """The `cover` of each obstacle; where all together take more than MOST_SPHERES, those that take most are one
    sphere each: whatever a scene holds, who solves for it has no more rows than that."""
    found = [cover(obstacle) for obstacle in obstacles]
    total = sum(len(radii) for _, radii in found)
    for index in sorted(range(len(found)), key=lambda i: -len(found[i][1])):
        if total <= MOST_SPHERES:
            break
        total -= len(found[index][1]) - 1
        found[index] = _one_around(obstacles[index].shape)
    return found


def plane_of(obstacle: Obstacle) -> tuple[Array, Array] | None:
    """Normal (3,) to the free side and a point (3,) (m) of a plane, base frame; None for other shapes."""
    if not isinstance(obstacle.shape, Plane):
        return None
    return np.array([row[2] for row in rotation(obstacle.orientation)]), np.array(obstacle.position)


@lru_cache(maxsize=256)
def closely_covered(shape: Shape) -> tuple[Array, Array] | None:
    """Spheres that leave a shape by EXCESS at most; None for a plane, and where it takes too many."""
    if isinstance(shape, Box):
        found = box_spheres(shape.half_extents, EXCESS, MAX_SPHERES)
    elif isinstance(shape, Mesh):
        found = mesh_spheres(shape.points, shape.hull, EXCESS, MAX_SPHERES)
    elif isinstance(shape, Capsule):
        found = _along(shape)
    elif isinstance(shape, Plane):
        found = None
    else:
        found = np.zeros((1, 3)), np.array([shape.radius])
    for array in found or ():
        array.flags.writeable = False  # the cache hands out the same arrays again
    return found


def _one_around(shape: Shape) -> tuple[Array, Array]:
    return np.zeros((1, 3)), np.array([shape.bounding_radius])


def _along(capsule: Capsule) -> tuple[Array, Array] | None:
    """As few spheres on the axis as do, then as small as that number permits.

    Spheres of radius r + e with 2s between their middles cover a tube of radius r where s^2 <= (r + e)^2 - r^2; the
    first and the last hold the caps where they lie e before the ends of the axis.
    """
    r, half = capsule.radius, capsule.half_length
    if half <= EXCESS:
        return np.zeros((1, 3)), np.array([r + half])
    count = 1 + math.ceil((half - EXCESS) / math.sqrt(EXCESS * (2 * r + EXCESS)))
    if count > MAX_SPHERES:
        return None
    low, high = 0.0, EXCESS
    while high - low > 1e-6:
        middle = 0.5 * (low + high)
        enough = (half - middle) / math.sqrt(middle * (2 * r + middle)) <= count - 1
        low, high = (low, middle) if enough else (middle, high)
    centres = np.zeros((count, 3))
    centres[:, 2] = np.linspace(high - half, half - high, count)
    return centres, np.full(count, r + high)
