"""Hostile runs of the robots that are a sphere around their tool: the point, and the box in PyBullet."""

import math
from typing import Any

import numpy as np
from numpy.random import Generator

from farhand.common.geometry import Array, Twist, to_vector3
from farhand.common.seeds import stream
from farhand.common.shapes.distance import distance_to
from farhand.common.shapes.obstacle import Obstacle
from farhand.robot_side.kernel.distance import capsule_row
from farhand.robot_side.robots.pybullet_box import BoxRobot
from farhand.robot_side.safety.guard.settings import GuardSettings
from farhand.robot_side.safety.guard.tool_guard import ToolGuard
from farhand.robot_side.scene.obstacle_field import ObstacleField
from farhand.trials.safety.adversary import Adversary
from farhand.trials.safety.outcome import Case, Outcome
from farhand.trials.safety.scenes import draw_scene, plane, sampled

RADIUS = 0.1
DT = 0.002
HALF = 1.2
"""m: half of the cube in which the scene lies; its walls are planes in every third scene."""
BOX_LAG = 0.1
SPEED = 1.0
"""m/s: of the commands, in each axis."""
START_CLEAR = 0.1  # m


class LimitedPoint:
    """lag v' = u - v with a bound on v', integrated in steps of a tick.

    Args:
        lag: (s).
        acceleration: (m/s^2); 0: no bound.
    """

    def __init__(self, lag: float, acceleration: float) -> None:
        self.position, self.velocity = np.zeros(3), np.zeros(3)
        self._share = 1.0 - math.exp(-DT / lag)
        self._most = acceleration * DT if acceleration > 0.0 else math.inf

    def step(self, twist: Twist) -> None:
        """One tick under a command."""
        change = self._share * (np.array(twist.linear) - self.velocity)
        length = float(np.linalg.norm(change))
        if length > self._most:
            change *= self._most / length
        self.position = self.position + DT * (self.velocity + 0.5 * change)
        self.velocity = self.velocity + change

    def close(self) -> None:
        """Nothing to give back."""


class RealBox:
    """The free-flying box, as the product drives it."""

    def __init__(self) -> None:
        self._box = BoxRobot((0.0, 0.0, 0.0))
        self._read()

    def _read(self) -> None:
        sample = self._box.sample()
        self.position, self.velocity = np.array(sample.position), np.array(sample.velocity)

    def step(self, twist: Twist) -> None:
        """One tick under a command."""
        self._box.step(twist, DT)
        self._read()

    def close(self) -> None:
        """Disconnect."""
        self._box.close()


def scene(seed: int, case: Case) -> tuple[Obstacle, ...]:
    """What stands and shuttles around the origin, where the robot starts."""
    rng = stream(seed, "guard", case.robot, "scene", str(case.scene), f"{case.speed:g}")

    def place(rng: Generator) -> Array:
        return np.asarray(rng.uniform(-HALF, HALF, 3))

    def fits(obstacle: Obstacle) -> bool:
        clear = RADIUS + START_CLEAR + (0.3 if obstacle.path else 0.0)
        return distance_to(obstacle, (0.0, 0.0, 0.0)) > clear

    count = 4 if case.speed else int(rng.integers(3, 13))
    found = draw_scene(rng, count=count, place=place, size=(0.05, 0.4), speed=case.speed, fits=fits)
    if rng.random() < 1 / 3:
        walls = np.vstack([np.eye(3), -np.eye(3)])
        found += tuple(plane(f"wall-{i}", to_vector3((-HALF * n).tolist()), n) for i, n in enumerate(walls))
    return found


def run_sphere(seed: int, case: Case, settings: GuardSettings) -> Outcome:
    """Drive it, and judge it at every tick by exact distances."""
    rng = stream(seed, "guard", case.robot, "run", f"{case.speed:g}", str(case.index))
    obstacles = scene(seed, case)
    field = ObstacleField(obstacles, 0)
    lag, body = _body(case, rng)
    told = lag / (1.0 + case.lag_error) if case.robot == "point" else BOX_LAG / (1.0 + case.lag_error)
    own = GuardSettings(d_min=settings.d_min, acceleration=case.acceleration)
    guard = ToolGuard(own, RADIUS, told, DT)
    judge = _Judge(obstacles)

    def towards() -> Array:
        return judge.towards(body.position, field.table(judge.now_ns).rows)

    adversary = Adversary(case.mode, rng, SPEED, 0.0, towards, DT)
    adversary._most[3:] = 1.0
    busy = 0
    way = 0.0
    try:
        for tick in range(round(case.duration / DT)):
            now_ns = round(tick * DT * 1e9)
            judge.now_ns = now_ns
            around = field.table(now_ns)
            judge.look(body.position, around, guard)
            twist = Twist(to_vector3(adversary.command()[:3].tolist()))
            if case.guarded:
                position, velocity = to_vector3(body.position.tolist()), to_vector3(body.velocity.tolist())
                twist = guard.allow(position, velocity, twist, around)
                busy += guard.did is not None
            body.step(twist)
            way += DT * float(np.linalg.norm(body.velocity))
    finally:
        body.close()
    ticks = max(1, round(case.duration / DT))
    return judge.outcome(case, settings.d_min, busy / ticks, guard.pinched, way)


def _body(case: Case, rng: Generator) -> tuple[float, Any]:
    """True lag and what moves."""
    if case.robot == "box":
        return BOX_LAG, RealBox()
    lag = float(rng.uniform(0.05, 0.3))
    return lag, LimitedPoint(lag, case.acceleration * (1.0 + case.acceleration_error))


class _Judge:
    """Attributes:
    now_ns: of the tick.
    nearest: least distance so far (m).
    """

    def __init__(self, obstacles: tuple[Obstacle, ...]) -> None:
        self._obstacles = obstacles
        self._index, self._where = -1, np.zeros(3)
        self._vertices = np.zeros((0, 3))
        self.now_ns, self._at_ns = 0, 0
        self.nearest = 1e6
        self._pinched_before, self._pinch_ns = 0, -1_000_000_000
        self._pinch_at_nearest = False

    def look(self, position: Array, around: Any, guard: ToolGuard) -> None:
        """Note the true distance now."""
        self._vertices = around.vertices
        if guard.pinched > self._pinched_before:
            self._pinched_before, self._pinch_ns = guard.pinched, self.now_ns
        gap, index = self._gap(position, around.rows)
        if gap < self.nearest:
            self.nearest, self._index, self._where = gap, index, position.copy()
            self._at_ns = self.now_ns
            self._pinch_at_nearest = self.now_ns - self._pinch_ns < 500_000_000

    def _gap(self, position: Array, rows: Array) -> tuple[float, int]:
        from farhand.robot_side.kernel.distance import nearest_row

        gap, index = nearest_row(position, position, RADIUS, rows, self._vertices)
        return float(gap), int(index)

    def towards(self, position: Array, rows: Array) -> Array:
        """The way to what is nearest."""
        _, index = self._gap(position, rows)
        if index < 0:
            return np.zeros(6)
        _, _, x, y, z = capsule_row(position, position, RADIUS, rows[index], self._vertices)
        return np.array([-x, -y, -z, 0.0, 0.0, 0.0])

    def outcome(self, case: Case, d_min: float, slowed: float, pinched: int, way: float) -> Outcome:
        """What came of it; the least distance once more by the shapes' own, plain measure."""
        name, nearest = "", self.nearest
        if self._index >= 0:
            there = ObstacleField(self._obstacles, 0).at(self._at_ns)[self._index]
            name = there.id
            plain = distance_to(there, to_vector3(self._where.tolist())) - RADIUS
            nearest = min(nearest, plain)
        reason = ""
        if nearest < d_min:
            reason = "pinched" if self._pinch_at_nearest else "unexplained"
        return Outcome(
            case=case,
            nearest=nearest,
            part="tool",
            obstacle=name,
            at=self._at_ns * 1e-9,
            reason=reason,
            slowed=slowed,
            pinched=pinched,
            travelled=way,
        )


__all__ = ["run_sphere", "sampled", "scene"]
