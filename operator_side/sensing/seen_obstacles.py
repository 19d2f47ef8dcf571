"""What the controller sees of a scene: spheres that cover the shapes, planes, and where they will be.

Rows are numbers for `ControlProblem`: all spheres first, then all planes. Within the horizon the controller takes a row
to go at constant velocity. For an obstacle that shuttles along a known path this is the chord of its way over the
horizon, and its radius grows by the largest distance between way and chord. For one that goes straight on but may
accelerate by up to a, it grows by a t^2 / 2, with t the time to the instant of effect and three steps more: what comes
later is planned anew before.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from farhand.common.geometry import Array
from farhand.common.messages.scene import Scene
from farhand.common.shapes.cover import covers, plane_of
from farhand.common.shapes.obstacle import Obstacle, place
from farhand.common.shapes.pose import rotation
from farhand.operator_side.control.settings import ControllerSettings

STEPS_AHEAD = 3


@dataclass(frozen=True, slots=True)
class Seen:
    """Rows at one instant.

    Attributes:
        centres: (n, 3), of a plane any of its points (m).
        velocities: (n, 3) (m/s).
        radii: (n,) all that is to be kept but for the margin; a plane's has no radius of its own (m).
        speeds: (n,) of the obstacles (m/s).
    """

    centres: Array
    velocities: Array
    radii: Array
    speeds: Array


class SeenObstacles:
    """The rows of one scene.

    Args:
        scene: as it came over the wire.
        keep: the robot's radius and d_min (m).
        settings: horizon and period.

    Attributes:
        ids: names of the obstacles, row by row.
        spheres: how many of the rows are spheres.
        normals: (n, 3) of the planes, zero for spheres; None where there are no planes.
    """

    def __init__(self, scene: Scene, keep: float, settings: ControllerSettings) -> None:
        self.scene = scene
        self._settings = settings
        balls = list(_balls(scene.obstacles))
        planes = [(o, found) for o in scene.obstacles if (found := plane_of(o)) is not None]
        owners = [o for o, *_ in balls] + [o for o, _ in planes]
        self.ids = [o.id for o in owners]
        self.spheres = len(balls)
        self._centres = _rows([c for _, c, _ in balls] + [point for _, (_, point) in planes])
        radii = np.array([keep + radius for *_, radius in balls] + [keep] * len(planes), dtype=float)
        velocities = _rows([o.velocity for o in owners])
        self.normals: Array | None = None
        if planes:
            self.normals = np.zeros_like(self._centres)
            self.normals[self.spheres :] = [normal for _, (normal, _) in planes]
        self._movers = [
            (obstacle, np.array([k for k, owner in enumerate(owners) if owner is obstacle]))
            for obstacle in scene.obstacles
            if obstacle.moves
        ]
        self._now = Seen(self._centres, velocities, radii, _lengths(velocities))

    def at(self, seconds: float) -> Seen:
        """The rows `seconds` after the scene's sample (s): where a plan begins."""
        if not self._movers:
            return self._now
        now = self._now
        centres, velocities, radii = self._centres.copy(), now.velocities.copy(), now.radii.copy()
        for obstacle, own in self._movers:
            moved, velocity, apart = self._chord(obstacle, seconds)
            centres[own] += moved
            velocities[own] = velocity
            radii[own] += apart
        return Seen(centres, velocities, radii, _lengths(velocities))

    def _chord(self, obstacle: Obstacle, seconds: float) -> tuple[Array, Array, float]:
        """How far it has gone by then (m), its velocity over the horizon (m/s), and how far it may be from that (m)."""
        period, horizon = self._settings.period, self._settings.horizon
        start = np.array(obstacle.position)
        if not obstacle.path:
            velocity = np.array(obstacle.velocity)
            ahead = max(0.0, seconds) + min(STEPS_AHEAD, horizon) * period
            return seconds * velocity, velocity, 0.5 * obstacle.acceleration * ahead**2
        way = np.array([place(obstacle, seconds + i * period)[0] for i in range(horizon + 1)])
        velocity = (way[-1] - way[0]) / (horizon * period)
        chord = way[0] + np.arange(horizon + 1)[:, None] * period * velocity
        return way[0] - start, velocity, float(_lengths(way - chord).max())


def _balls(obstacles: Sequence[Obstacle]) -> Iterator[tuple[Obstacle, Array, float]]:
    """Each sphere with its obstacle, its centre in the base frame and its radius (m)."""
    for obstacle, spheres in zip(obstacles, covers(obstacles), strict=True):
        turn, position = np.array(rotation(obstacle.orientation)), np.array(obstacle.position)
        for centre, radius in zip(*spheres, strict=True):
            yield obstacle, position + turn @ centre, float(radius)


def _rows(vectors: Sequence[Array] | Sequence[Sequence[float]]) -> Array:
    return np.array(vectors, dtype=float).reshape(-1, 3)


def _lengths(vectors: Array) -> Array:
    lengths: Array = np.sqrt(np.einsum("jk,jk->j", vectors, vectors))
    return lengths
