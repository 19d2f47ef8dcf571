"""Exact signed distances to obstacles in the base frame."""

import math
from collections.abc import Iterable

from farhand.common.quantities import Vector3
from farhand.common.shapes.obstacle import Obstacle
from farhand.common.shapes.pose import into, out_of, rotation


def distance_to(obstacle: Obstacle, point: Vector3) -> float:
    """From an obstacle's surface to a point, negative inside (m)."""
    return obstacle.shape.distance(*into(rotation(obstacle.orientation), obstacle.position, point))


def witness_on(obstacle: Obstacle, point: Vector3) -> Vector3:
    """The point of an obstacle's surface that is nearest to a point (m)."""
    rows = rotation(obstacle.orientation)
    return out_of(rows, obstacle.position, obstacle.shape.witness(*into(rows, obstacle.position, point)))


def nearest_obstacle(obstacles: Iterable[Obstacle], point: Vector3) -> tuple[float, str]:
    """Distance of a point to the nearest obstacle (m) and its id; infinity and an empty name without any."""
    return min(((distance_to(o, point), o.id) for o in obstacles), default=(math.inf, ""))
