"""Spheres in PyBullet that are only measured against, never touched."""

from collections.abc import Sequence
from typing import Any

from farhand.common.messages.base import Vector3
from farhand.common.messages.scene import Obstacle

_FAR = 10.0  # m; what is farther away is not there


class BulletObstacles:
    """Mirrors a list of obstacles in the physics engine, and measures distances to one body.

    Args:
        bullet: the pybullet module.
        client: its world.
        body: what distances are measured from.
    """

    def __init__(self, bullet: Any, client: int, body: int) -> None:
        self._bullet, self._client, self._body = bullet, client, body
        self._shapes: list[tuple[str, float]] = []
        self._spheres: list[int] = []
        self._positions: list[Vector3] = []

    def nearest(self, obstacles: Sequence[Obstacle]) -> tuple[float, str] | None:
        """Distance of the body to the nearest obstacle (m) and its id; None without obstacles near."""
        self._place(obstacles)
        best, name = _FAR, ""
        for obstacle, sphere in zip(obstacles, self._spheres, strict=True):
            # Asking only for what is nearer than the best so far lets Bullet skip the rest.
            points = self._bullet.getClosestPoints(self._body, sphere, best, physicsClientId=self._client)
            gap = min((point[8] for point in points), default=_FAR)
            if gap < best:
                best, name = gap, obstacle.id
        return (best, name) if name else None

    def nearest_link(self, obstacles: Sequence[Obstacle]) -> tuple[int, str]:
        """Index of the body's link that is nearest to an obstacle, and its id; -1 and empty without any near."""
        self._place(obstacles)
        found = [
            (point[8], point[3], obstacle.id)
            for obstacle, sphere in zip(obstacles, self._spheres, strict=True)
            for point in self._bullet.getClosestPoints(self._body, sphere, _FAR, physicsClientId=self._client)
        ]
        return min(found)[1:] if found else (-1, "")

    def _place(self, obstacles: Sequence[Obstacle]) -> None:
        bullet, client = self._bullet, self._client
        shapes = [(obstacle.id, obstacle.radius) for obstacle in obstacles]
        if shapes != self._shapes:
            for sphere in self._spheres:
                bullet.removeBody(sphere, physicsClientId=client)
            self._spheres = [self._make(obstacle) for obstacle in obstacles]
            self._shapes, self._positions = shapes, [obstacle.position for obstacle in obstacles]
        for index, obstacle in enumerate(obstacles):
            if obstacle.position != self._positions[index]:
                self._positions[index] = obstacle.position
                bullet.resetBasePositionAndOrientation(
                    self._spheres[index], obstacle.position, (0, 0, 0, 1), physicsClientId=client
                )

    def _make(self, obstacle: Obstacle) -> int:
        bullet, client = self._bullet, self._client
        shape = bullet.createCollisionShape(
            bullet.GEOM_SPHERE, radius=obstacle.radius, physicsClientId=client
        )
        sphere: int = bullet.createMultiBody(
            0.0, shape, basePosition=obstacle.position, physicsClientId=client
        )
        bullet.setCollisionFilterGroupMask(sphere, -1, 0, 0, physicsClientId=client)
        return sphere
