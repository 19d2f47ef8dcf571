"""Shapes in PyBullet that are only measured against, never touched."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from farhand.common.geometry import Array
from farhand.common.messages.base import Quaternion, Vector3
from farhand.common.messages.scene import Obstacle
from farhand.common.shapes.box import Box
from farhand.common.shapes.capsule import Capsule
from farhand.common.shapes.mesh import Mesh
from farhand.common.shapes.shape import Shape
from farhand.common.shapes.sphere import Sphere
from farhand.robot_side.kernel.floors import sink

_FAR = 10.0  # m; what is farther away is not there
_AHEAD = 0.2  # m
_ROUNDING = 1e-6  # m, of a bound; far more than sums of floats lose
# Bullet rounds edges by a margin. A box is exact without one, and up to 0.7 mm too far away with its own 1 mm; of
# meshes the distance scatters by 0.05 mm, which the margin outweighs, so that none is taken to be too far away.
_BOX_MARGIN, _MESH_MARGIN = 0.0, 1e-4  # m


class BulletObstacles:
    """Mirrors a list of obstacles in the physics engine, and measures distances to one body.

    Args:
        bullet: the pybullet module.
        client: its world.
        body: what distances are measured from.
        first: of its links, the first one that moves: a base may stand on an obstacle, and cannot leave it.
    """

    def __init__(self, bullet: Any, client: int, body: int, first: int = -1) -> None:
        self._bullet, self._client, self._body, self._first = bullet, client, body, first
        self._shapes: list[tuple[str, Shape, Quaternion]] = []
        self._solids: list[int] = []
        self._positions: list[Vector3] = []
        self._placed: Sequence[Obstacle] = ()
        # No link is nearer to an obstacle than its floor (m), and the pair that was the nearest is not farther apart
        # than the ceiling.
        self._links: list[int] = []
        self._floors: Array = np.zeros((0, 0))  # (obstacles, links)
        self._order, self._still = np.zeros(0, np.int64), np.zeros(0)
        self._nearest, self._ceiling = -1, _FAR  # the pair's place in the floors; m

    def nearest(
        self, obstacles: Sequence[Obstacle], moved: Array | None = None
    ) -> tuple[float, str, int] | None:
        """Distance of the body to the nearest obstacle (m), its id, and the link; None without obstacles near.

        Args:
            obstacles: where they are now.
            moved: (links,) no point of a link has moved by more than this since the last call (m); None: by whatever.
                Links that cannot have come nearest are not measured again.
        """
        self._place(obstacles)
        if moved is None:
            self._forget()
            moved = self._still
        found, first, links = (_FAR, -1, -1), self._nearest, len(self._links)
        if first >= 0:  # the pair that was the nearest most often is, and leaves few to look at
            farthest = min(_FAR, self._ceiling + moved.item(first % links) + _ROUNDING)
            found = self._measure(first, (farthest, len(obstacles), -1))
        count = sink(self._floors, moved, first, found[0] + _ROUNDING, self._order)
        if count:
            for place in self._order[:count].tolist():
                if self._floors.item(place) >= found[0] + _ROUNDING:
                    break
                found = self._measure(place, found)
        best, k, i = found
        if i < 0:
            self._nearest = -1
            return None
        self._nearest, self._ceiling = k * links + i, best
        return best, obstacles[k].id, self._links[i]

    def _measure(self, place: int, found: tuple[float, int, int]) -> tuple[float, int, int]:
        """The nearest pair so far, or the one at a place of the floors, if it is nearer: distance, obstacle, link."""
        k, i = divmod(place, len(self._links))
        # The nearer the limit, the more Bullet skips; a little more spares asking again the next times.
        reach = found[0] if found[2] < 0 else min(_FAR, found[0] + _AHEAD)
        points = self._bullet.getClosestPoints(
            self._body, self._solids[k], reach, self._links[i], physicsClientId=self._client
        )
        gap = min([point[8] for point in points], default=reach)
        self._floors[k, i] = gap
        return min(found, (gap, k, i)) if points else found

    def _forget(self) -> None:
        """Nothing is known of any distance."""
        if not self._links:
            count = self._bullet.getNumJoints(self._body, physicsClientId=self._client)
            self._links = list(range(self._first, count))
        self._floors = np.full((len(self._solids), len(self._links)), -math.inf)
        self._order, self._still = np.zeros(self._floors.size, np.int64), np.zeros(len(self._links))
        self._nearest = -1

    def remove(self) -> None:
        """Take them out of the world again."""
        for solid in self._solids:
            self._bullet.removeBody(solid, physicsClientId=self._client)
        self._solids, self._shapes, self._placed = [], [], ()

    def _place(self, obstacles: Sequence[Obstacle]) -> None:
        """Put them where they are."""
        if obstacles is self._placed:
            return
        bullet, client = self._bullet, self._client
        shapes = [(obstacle.id, obstacle.shape, obstacle.orientation) for obstacle in obstacles]
        if shapes != self._shapes:
            self.remove()
            self._solids = [self._make(obstacle) for obstacle in obstacles]
            self._shapes, self._positions = shapes, [obstacle.position for obstacle in obstacles]
            self._forget()
        if isinstance(obstacles, tuple):  # which nobody changes
            self._placed = obstacles
        for index, obstacle in enumerate(obstacles):
            if obstacle.position != self._positions[index]:
                came = math.dist(obstacle.position, self._positions[index])
                self._floors[index] -= came
                if self._nearest >= 0 and index == self._nearest // len(self._links):
                    self._ceiling += came
                self._positions[index] = obstacle.position
                bullet.resetBasePositionAndOrientation(
                    self._solids[index],
                    obstacle.position,
                    _turn(obstacle.orientation),
                    physicsClientId=client,
                )

    def _make(self, obstacle: Obstacle) -> int:
        bullet, client = self._bullet, self._client
        shape = bullet.createCollisionShape(**self._geometry(obstacle.shape), physicsClientId=client)
        solid: int = bullet.createMultiBody(
            0.0,
            shape,
            basePosition=obstacle.position,
            baseOrientation=_turn(obstacle.orientation),
            physicsClientId=client,
        )
        bullet.setCollisionFilterGroupMask(solid, -1, 0, 0, physicsClientId=client)
        if isinstance(obstacle.shape, Box | Mesh):
            margin = _BOX_MARGIN if isinstance(obstacle.shape, Box) else _MESH_MARGIN
            bullet.changeDynamics(solid, -1, collisionMargin=margin, physicsClientId=client)
        return solid

    def _geometry(self, shape: Shape) -> dict[str, Any]:
        bullet = self._bullet
        if isinstance(shape, Sphere):
            return {"shapeType": bullet.GEOM_SPHERE, "radius": shape.radius}
        if isinstance(shape, Capsule):
            return {
                "shapeType": bullet.GEOM_CAPSULE,
                "radius": shape.radius,
                "height": 2 * shape.half_length,
            }
        if isinstance(shape, Box):
            return {"shapeType": bullet.GEOM_BOX, "halfExtents": shape.half_extents}
        if isinstance(shape, Mesh):
            return {"shapeType": bullet.GEOM_MESH, "vertices": shape.points.tolist()}
        return {"shapeType": bullet.GEOM_PLANE, "planeNormal": (0.0, 0.0, 1.0)}


def _turn(orientation: Quaternion) -> Quaternion:
    """Bullet writes quaternions (x, y, z, w)."""
    w, x, y, z = orientation
    return (x, y, z, w)
