"""Where the obstacles truly are, and how far the robot is from them."""

import math
from collections.abc import Sequence

import numpy as np

from farhand.common.messages.base import Vector3
from farhand.common.messages.scene import Obstacle
from farhand.common.shapes.obstacle import moved, way_of
from farhand.common.shapes.pose import rotation
from farhand.common.shapes.sphere import Sphere
from farhand.robot_side.scene.surroundings import Surroundings, surroundings_of

NOTHING_NEAR = 1e6
_FEW = 24  # up to here a plain loop beats numpy's call overhead


class ObstacleField:
    """Obstacles that stand still, move at constant velocity, or shuttle along a path.

    Args:
        obstacles: as they are at `start_ns`.
        start_ns: robot clock.

    Attributes:
        moves: whether any of them does.
    """

    def __init__(self, obstacles: Sequence[Obstacle], start_ns: int) -> None:
        self._obstacles = tuple(obstacles)
        self._start_ns = self._table_ns = start_ns
        self._movers = [(index, way_of(o)) for index, o in enumerate(obstacles) if o.moves]
        self.moves = bool(self._movers)
        self._table = surroundings_of(self._obstacles)
        # Spheres that stand or move straight on, the common case, are a loop over plain numbers.
        spheres = [(o, o.shape.radius) for o in obstacles if isinstance(o.shape, Sphere) and not o.path]
        self._few = [(*o.position, radius, *o.velocity) for o, radius in spheres]
        self._centres = np.array([o.position for o, _ in spheres]).reshape(-1, 3)
        self._velocities = np.array([o.velocity for o, _ in spheres]).reshape(-1, 3)
        self._radii = np.array([radius for _, radius in spheres])
        self._others = [
            (
                o.position,
                way_of(o) if o.moves else None,
                o.shape,
                o.shape.bounding_radius,
                rotation(o.orientation),
            )
            for o in obstacles
            if not isinstance(o.shape, Sphere) or o.path
        ]

    def at(self, now_ns: int) -> tuple[Obstacle, ...]:
        """The obstacles where they are at `now_ns`."""
        if not self.moves:
            return self._obstacles
        t = (now_ns - self._start_ns) * 1e-9
        return tuple(moved(o, t) for o in self._obstacles)

    def table(self, now_ns: int) -> Surroundings:
        """The same as numbers; always the one object, whose rows of movers are changed in place."""
        if self._movers and now_ns != self._table_ns:
            self._table_ns = now_ns
            t = (now_ns - self._start_ns) * 1e-9
            for index, way in self._movers:
                self._table.move(index, *way(t))
        return self._table

    def clearance(self, point: Vector3, radius: float, now_ns: int) -> float:
        """Distance of a sphere around `point` to the nearest obstacle at `now_ns` (m); 1e6 without any."""
        t = 0.0 if not self.moves else (now_ns - self._start_ns) * 1e-9
        nearest = NOTHING_NEAR + radius
        if len(self._few) > _FEW:
            offsets = self._centres + t * self._velocities - np.asarray(point)
            nearest = float((np.sqrt(np.einsum("ij,ij->i", offsets, offsets)) - self._radii).min())
        else:
            x, y, z = point
            for px, py, pz, r, vx, vy, vz in self._few:
                dx, dy, dz = px + t * vx - x, py + t * vy - y, pz + t * vz - z
                gap = math.sqrt(dx * dx + dy * dy + dz * dz) - r
                if gap < nearest:
                    nearest = gap
        if self._others:
            nearest = self._to_others(point, t, nearest)
        return nearest - radius

    def _to_others(self, point: Vector3, t: float, nearest: float) -> float:
        """The distance to the nearest shape, or `nearest` where none is nearer (m)."""
        x, y, z = point
        for position, way, shape, bound, ((a, b, c), (d, e, f), (g, h, i)) in self._others:
            px, py, pz = position if way is None else way(t)[0]
            dx, dy, dz = x - px, y - py, z - pz
            if math.sqrt(dx * dx + dy * dy + dz * dz) - bound < nearest:
                gap = shape.distance(
                    a * dx + d * dy + g * dz, b * dx + e * dy + h * dz, c * dx + f * dy + i * dz
                )
                nearest = min(nearest, gap)
        return nearest
