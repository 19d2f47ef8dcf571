"""What a solver of spheres and planes sees of an obstacle: spheres that cover it, or a plane."""

import numpy as np

from farhand.common.geometry import Array
from farhand.common.shapes.obstacle import Obstacle
from farhand.common.shapes.plane import Plane
from farhand.common.shapes.pose import rotation


def cover(obstacle: Obstacle) -> tuple[Array, Array]:
    """Spheres that cover all of an obstacle: centres (k, 3) in its own frame and radii (k,) (m).

    A plane has none: see `plane_of`.
    """
    if isinstance(obstacle.shape, Plane):
        return np.zeros((0, 3)), np.zeros(0)
    return np.zeros((1, 3)), np.array([obstacle.shape.bounding_radius])


def plane_of(obstacle: Obstacle) -> tuple[Array, Array] | None:
    """Normal (3,) to the free side and a point (3,) (m) of a plane, base frame; None for other shapes."""
    if not isinstance(obstacle.shape, Plane):
        return None
    return np.array([row[2] for row in rotation(obstacle.orientation)]), np.array(obstacle.position)
