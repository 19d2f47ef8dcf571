"""Where the obstacles truly are, and how far the robot is from them."""

import math
from collections.abc import Sequence

import msgspec
import numpy as np

from farhand.common.messages.base import Vector3
from farhand.common.messages.scene import Obstacle

NOTHING_NEAR = 1e6
_FEW = 24  # up to here a plain loop beats numpy's call overhead


class ObstacleField:
    """Spheres that stand still or move at constant velocity.

    Args:
        obstacles: as they are at `start_ns`.
        start_ns: robot clock.
    """

    def __init__(self, obstacles: Sequence[Obstacle], start_ns: int) -> None:
        self._obstacles = tuple(obstacles)
        self._start_ns = start_ns
        self._still = not any(any(o.velocity) for o in obstacles)
        self._few = [(*o.position, o.radius, *o.velocity) for o in obstacles]
        self._centres = np.array([o.position for o in obstacles]).reshape(-1, 3)
        self._velocities = np.array([o.velocity for o in obstacles]).reshape(-1, 3)
        self._radii = np.array([o.radius for o in obstacles])

    def at(self, now_ns: int) -> tuple[Obstacle, ...]:
        """The obstacles where they are at `now_ns`."""
        if self._still:
            return self._obstacles
        t = (now_ns - self._start_ns) * 1e-9
        return tuple(
            msgspec.structs.replace(o, position=_moved(o.position, o.velocity, t)) for o in self._obstacles
        )

    def clearance(self, point: Vector3, radius: float, now_ns: int) -> float:
        """Distance of a sphere around `point` to the nearest obstacle at `now_ns` (m); 1e6 without any."""
        t = 0.0 if self._still else (now_ns - self._start_ns) * 1e-9
        if len(self._few) > _FEW:
            offsets = self._centres + t * self._velocities - np.asarray(point)
            gaps = np.sqrt(np.einsum("ij,ij->i", offsets, offsets)) - self._radii
            return float(gaps.min()) - radius
        x, y, z = point
        nearest = NOTHING_NEAR + radius
        for px, py, pz, r, vx, vy, vz in self._few:
            dx, dy, dz = px + t * vx - x, py + t * vy - y, pz + t * vz - z
            gap = math.sqrt(dx * dx + dy * dy + dz * dz) - r
            if gap < nearest:
                nearest = gap
        return nearest - radius


def nearest_obstacle(obstacles: Sequence[Obstacle], point: Vector3) -> str:
    """Name of the obstacle that is nearest to a point; empty without any."""
    nearest = min(obstacles, key=lambda o: math.dist(o.position, point) - o.radius, default=None)
    return nearest.id if nearest is not None else ""


def _moved(position: Vector3, velocity: Vector3, t: float) -> Vector3:
    return (
        position[0] + t * velocity[0],
        position[1] + t * velocity[1],
        position[2] + t * velocity[2],
    )
