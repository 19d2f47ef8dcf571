"""Shapes in PyBullet that are only measured against, never touched."""

import math
from collections.abc import Sequence
from typing import Any

from farhand.common.messages.base import Quaternion, Vector3
from farhand.common.messages.scene import Obstacle
from farhand.common.shapes.box import Box
from farhand.common.shapes.capsule import Capsule
from farhand.common.shapes.mesh import Mesh
from farhand.common.shapes.shape import Shape
from farhand.common.shapes.sphere import Sphere

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
        # than the ceiling. All floors sink by what the body moves: that is kept once, in `sunk`.
        self._links: list[int] = []
        self._floors: list[list[float]] = []
        self._lowest: list[float] = []  # of each obstacle's floors
        self._sunk = 0.0
        self._nearest, self._ceiling = -1, _FAR

    def nearest(
        self, obstacles: Sequence[Obstacle], moved: float = math.inf
    ) -> tuple[float, str, int] | None:
        """Distance of the body to the nearest obstacle (m), its id, and the link; None without obstacles near.

        Args:
            obstacles: where they are now.
            moved: no point of the body has moved by more than this since the last call (m). Links that cannot have
                come nearest are not measured again.
        """
        self._place(obstacles)
        self._sink(moved)
        found = (_FAR, -1, -1)  # distance, obstacle, link: of equals the first
        if self._nearest >= 0:
            found = (min(_FAR, self._ceiling + moved + _ROUNDING), len(obstacles), -1)
        for low, k in _lowest_first(self._lowest, found[0] + self._sunk):
            if low >= found[0] + self._sunk + _ROUNDING:
                break
            found = self._measure(k, found)
        best, index, link = found
        self._nearest = index if 0 <= index < len(obstacles) else -1
        self._ceiling = best
        return (best, obstacles[index].id, link) if self._nearest >= 0 else None

    def _measure(self, k: int, found: tuple[float, int, int]) -> tuple[float, int, int]:
        """The nearest pair so far, or a nearer one of obstacle k."""
        floors, sunk, solid, client = self._floors[k], self._sunk, self._solids[k], self._client
        for floor, i in _lowest_first(floors, found[0] + sunk):
            best, link = found[0], self._links[i]
            if floor >= best + sunk + _ROUNDING:
                break
            # The nearer the limit, the more Bullet skips; a little more spares asking again the next times.
            reach = best if found[2] == -1 else min(_FAR, best + _AHEAD)
            points = self._bullet.getClosestPoints(self._body, solid, reach, link, physicsClientId=client)
            gap = min([point[8] for point in points], default=reach)
            floors[i] = gap + sunk
            if points:
                found = min(found, (gap, k, link))
        self._lowest[k] = min(floors)
        return found

    def _sink(self, moved: float) -> None:
        """No point of the body has moved by more than this since (m)."""
        if moved < math.inf:
            self._sunk += moved
            return
        if not self._links:
            count = self._bullet.getNumJoints(self._body, physicsClientId=self._client)
            self._links = list(range(self._first, count))
        self._floors = [[-math.inf] * len(self._links) for _ in self._solids]
        self._lowest = [-math.inf] * len(self._solids)
        self._sunk, self._nearest = 0.0, -1

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
            self._sink(math.inf)
        if isinstance(obstacles, tuple):  # which nobody changes
            self._placed = obstacles
        for index, obstacle in enumerate(obstacles):
            if obstacle.position != self._positions[index]:
                came = math.dist(obstacle.position, self._positions[index])
                self._floors[index] = [floor - came for floor in self._floors[index]]
                self._lowest[index] -= came
                if index == self._nearest:
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


def _lowest_first(floors: list[float], limit: float) -> list[tuple[float, int]]:
    """What lies under a limit (m), and where in the list: most lies above, and is not sorted."""
    return sorted([(floor, i) for i, floor in enumerate(floors) if floor < limit + _ROUNDING])


def _turn(orientation: Quaternion) -> Quaternion:
    """Bullet writes quaternions (x, y, z, w)."""
    w, x, y, z = orientation
    return (x, y, z, w)
