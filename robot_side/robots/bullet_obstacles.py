"""Shapes in PyBullet that are only measured against, never touched."""

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

    def nearest(self, obstacles: Sequence[Obstacle]) -> tuple[float, str] | None:
        """Distance of the body to the nearest obstacle (m) and its id; None without obstacles near."""
        self._place(obstacles)
        best, name = _FAR, ""
        for obstacle, solid in zip(obstacles, self._solids, strict=True):
            # Asking only for what is nearer than the best so far lets Bullet skip the rest.
            points = self._bullet.getClosestPoints(self._body, solid, best, physicsClientId=self._client)
            gap = min((point[8] for point in points if point[3] >= self._first), default=_FAR)
            if gap < best:
                best, name = gap, obstacle.id
        return (best, name) if name else None

    def nearest_link(self, obstacles: Sequence[Obstacle]) -> tuple[int, str]:
        """Index of the body's link that is nearest to an obstacle, and its id; -1 and empty without any near."""
        self._place(obstacles)
        found = [
            (point[8], point[3], obstacle.id)
            for obstacle, solid in zip(obstacles, self._solids, strict=True)
            for point in self._bullet.getClosestPoints(self._body, solid, _FAR, physicsClientId=self._client)
            if point[3] >= self._first
        ]
        return min(found)[1:] if found else (-1, "")

    def _place(self, obstacles: Sequence[Obstacle]) -> None:
        bullet, client = self._bullet, self._client
        shapes = [(obstacle.id, obstacle.shape, obstacle.orientation) for obstacle in obstacles]
        if shapes != self._shapes:
            for solid in self._solids:
                bullet.removeBody(solid, physicsClientId=client)
            self._solids = [self._make(obstacle) for obstacle in obstacles]
            self._shapes, self._positions = shapes, [obstacle.position for obstacle in obstacles]
        for index, obstacle in enumerate(obstacles):
            if obstacle.position != self._positions[index]:
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
