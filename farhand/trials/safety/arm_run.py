"""Hostile runs of an arm: kinematic, with a lag and bounded accelerations of its own, or in PyBullet."""

import math

import numpy as np
from numpy.random import Generator

from farhand.common.geometry import Array, to_vector3
from farhand.common.seeds import stream
from farhand.common.shapes.obstacle import Obstacle
from farhand.common.shapes.plane import Plane
from farhand.robot_side.arm.kinematics import Kinematics
from farhand.robot_side.arm.model import ArmModel, model
from farhand.robot_side.kernel.distance import capsule_row
from farhand.robot_side.safety.guard.arm_guard import ArmGuard, Body, Joints, placed
from farhand.robot_side.safety.guard.settings import GuardSettings
from farhand.robot_side.scene.obstacle_field import ObstacleField
from farhand.robot_side.scene.surroundings import Surroundings, surroundings_of
from farhand.trials.safety.adversary import Adversary
from farhand.trials.safety.outcome import Case, Outcome
from farhand.trials.safety.scenes import draw_scene, plane, sampled
from farhand.trials.safety.sweep import sweep
from farhand.trials.safety.truth import Meshes, Pairs

DT = 0.002
LAG = 0.016
"""s, as the guard is told."""
LINEAR, ANGULAR = 2.0, 2.0
"""Limits of the commands in each axis (m/s, rad/s): those of the watchdog."""
START_CLEAR = 0.03  # m
MOVER_CLEAR = 0.2
"""m: from the start to where a mover begins."""
COLUMN = 0.3
"""m: movers keep this off the axis of the first joint, whose column cannot step aside."""
NEAR = 0.025
"""m: nearer than this by capsules the meshes are measured as well."""
EVERY = 5
"""Looks between two of these, unless the capsules are nearer than they may be."""


class KinematicArm:
    """Joints that follow commanded velocities with a lag and bounded accelerations.

    Args:
        q: (n,) at the start (rad).
        lag: (s).
        acceleration: (n,) rad/s^2.
    """

    def __init__(self, q: Array, lag: float, acceleration: Array) -> None:
        self.q, self.qd = q.copy(), np.zeros(len(q))
        self._share = 1.0 - math.exp(-DT / lag)
        self._most = acceleration * DT

    def step(self, commanded: Array) -> None:
        """One tick."""
        change = np.minimum(np.maximum(self._share * (commanded - self.qd), -self._most), self._most)
        self.q = self.q + DT * (self.qd + 0.5 * change)
        self.qd = self.qd + change


class Judge:
    """Measures what is true at a tick: capsules always, meshes where it is close.

    Args:
        arm, body: of the arm.
        obstacles: as they are at the start.
        d_min: to be kept (m).
        every: looks between two at the meshes of what is near, unless capsules are nearer than they may be; where it
            is not every look, the arm itself is looked at in every second one.
    """

    def __init__(
        self, arm: ArmModel, body: Body, obstacles: tuple[Obstacle, ...], d_min: float, every: int = EVERY
    ) -> None:
        self._body, self._d_min, self._every = body, d_min, every
        self._meshes = Meshes(arm)
        self._field = ObstacleField(obstacles, 0)
        self._planes = np.array([isinstance(o.shape, Plane) for o in obstacles], dtype=bool)
        moving = np.array([i for i in range(body.whole) if body.capsules[i, 0] >= 0])
        self._arm = body.capsules, moving
        self._bounds = np.array([d_min, NEAR])
        self._close = np.zeros((max(1, len(moving) * len(obstacles)), 2), dtype=np.int64)
        self._pairs = Pairs(self._meshes.pairs(arm.home, d_min), arm.n)
        self.nearest, self.nearest_self = 1e6, 1e6
        self.part, self.obstacle, self.at = "", "", 0.0
        self.two = ""
        self._tick = 0

    def look(self, q: Array, around: Surroundings, t: float) -> tuple[float, int, int]:
        """Note the truth now; returns the least distance by capsules, its capsule and its obstacle."""
        around_it = around.rows, around.vertices, self._planes
        often = self._tick % self._every == 0
        best, which, whose, count = sweep(
            placed(self._body, q), self._arm, around_it, self._bounds, often, self._close
        )
        found = self._close[:count].tolist()
        if found:
            self._measure(q, found, t)
        elif best < self.nearest and best >= NEAR:
            self._note(best, which, whose, t)
        self._look_at_itself(q)
        self._tick += 1
        return best, which, whose

    def _note(self, distance: float, which: int, whose: int, t: float) -> None:
        self.nearest, self.at = distance, t
        self.part, self.obstacle = self._body.parts[which], self._field.at(0)[whose].id

    def _measure(self, q: Array, found: list[list[int]], t: float) -> None:
        self._meshes.place(q)
        obstacles = self._field.at(round(t * 1e9))
        for i, j in found:
            d = self._meshes.distance(self._body.parts[i], obstacles[j])
            if d < self.nearest:
                self._note(d, i, j, t)

    def _look_at_itself(self, q: Array) -> None:
        if self._tick % 2 and self._every > 1:
            return
        near = self._pairs.nearer_than(self._d_min, q)
        if not near:
            return
        self._meshes.place(q)
        for k in near:
            pair = self._pairs[k]
            d = self._meshes.between(pair.one, pair.other, NEAR)
            self._pairs.measured(k, q, d)
            if d < self.nearest_self:
                self.nearest_self, self.two = d, f"{pair.one} and {pair.other}"


def arm_scene(seed: int, case: Case, arm: ArmModel, body: Body) -> tuple[Obstacle, ...]:
    """What stands and shuttles around the arm; in every second scene it stands on a table, in some beside a wall."""
    rng = stream(seed, "guard", case.robot, "scene", str(case.scene), f"{case.speed:g}")
    start = _Start(arm, body)
    count = 3 if case.speed else int(rng.integers(3, 13))
    found = draw_scene(
        rng, count=count, place=start.place, size=(0.03, 0.15), speed=case.speed, fits=start.has_room_for
    )
    if rng.random() < 0.5:
        found += (plane("table", (0.0, 0.0, 0.0), np.array([0.0, 0.0, 1.0])),)
    if rng.random() < 0.3:
        angle = float(rng.uniform(0.0, 2.0 * np.pi))
        normal = np.array([-math.cos(angle), -math.sin(angle), 0.0])
        wall = plane("wall", to_vector3((-normal * rng.uniform(0.5, 0.9)).tolist()), normal)
        if start.gap(wall) > START_CLEAR:
            found += (wall,)
    return found


class _Start:
    """The arm at home, and where obstacles may be around it."""

    def __init__(self, arm: ArmModel, body: Body) -> None:
        A, B = placed(body, arm.home)
        self._A, self._B, self._radii = A[: body.whole], B[: body.whole], body.capsules[: body.whole, 7]
        self._reach = 0.95 * arm.longest_reach

    def gap(self, obstacle: Obstacle) -> float:
        """Of the arm to an obstacle (m)."""
        table = surroundings_of([obstacle])
        ends = zip(self._A, self._B, self._radii, strict=True)
        return min(float(capsule_row(a, b, r, table.rows[0], table.vertices)[0]) for a, b, r in ends)

    def place(self, rng: Generator) -> Array:
        """(3,) somewhere within reach (m)."""
        while True:
            x = rng.uniform(-self._reach, self._reach, 3)
            x[2] = abs(x[2])
            if 0.15 < float(np.linalg.norm(x)) < self._reach:
                return np.asarray(x)

    def has_room_for(self, obstacle: Obstacle) -> bool:
        """Whether an obstacle is clear of the arm, and a mover's way of the column that cannot step aside."""
        if not obstacle.path:
            return self.gap(obstacle) > START_CLEAR
        places = sampled(obstacle)
        foot, top = np.zeros(3), np.array([0.0, 0.0, COLUMN])
        tables = [surroundings_of([where]) for where in places]
        clear = all(capsule_row(foot, top, COLUMN, t.rows[0], t.vertices)[0] > 0.0 for t in tables)
        return clear and self.gap(places[0]) > MOVER_CLEAR


def run_arm(seed: int, case: Case, settings: GuardSettings) -> Outcome:
    """Drive it, and judge it at every tick."""
    rng = stream(seed, "guard", case.robot, "run", f"{case.speed:g}", str(case.index))
    arm = model(case.robot)
    guard = ArmGuard(arm, settings, LAG, DT)
    obstacles = arm_scene(seed, case, arm, guard.body)
    if not case.guarded:
        obstacles_seen: tuple[Obstacle, ...] = ()
    else:
        obstacles_seen = obstacles
    field, seen = ObstacleField(obstacles, 0), ObstacleField(obstacles_seen, 0)
    kinematics = Kinematics(arm)
    true_acceleration = arm.max_acceleration * (1.0 + case.acceleration_error)
    body = KinematicArm(arm.home, LAG * (1.0 + case.lag_error), true_acceleration)
    judge = Judge(arm, guard.body, obstacles, settings.d_min)
    near: list[tuple[float, int, int]] = [(1e6, -1, -1)]
    around = field.table(0)
    tool = kinematics.tool(body.q)

    def towards() -> Array:
        _, which, whose = near[0]
        if which < 0:
            return np.zeros(6)
        return np.asarray(tool.jacobian @ closing(arm, guard.body, body.q, which, around, whose))

    adversary = Adversary(case.mode, rng, LINEAR, ANGULAR, towards, DT)
    wanted = tool.R_base_tool.copy()
    commanded = np.zeros(arm.n)
    busy, way = 0, 0.0
    pinch_at, pinched = -1.0, 0
    ticks = round(case.duration / DT)
    reason = ""
    for tick in range(ticks):
        t = tick * DT
        now_ns = round(t * 1e9)
        around = field.table(now_ns)
        before = judge.nearest
        near[0] = judge.look(body.q, around, t)
        if guard.pinched > pinched:
            pinched, pinch_at = guard.pinched, t
        if judge.nearest < min(before, settings.d_min):
            reason = "pinched" if t - pinch_at < 0.5 else "unexplained"
        tool = kinematics.tool(body.q)
        twist = adversary.command()
        v, w = np.ascontiguousarray(twist[:3]), np.ascontiguousarray(twist[3:])
        commanded = guard.command(Joints(body.q, body.qd, commanded), v, w, wanted, seen.table(now_ns))
        busy += guard.did is not None
        body.step(commanded)
        way += DT * float(np.linalg.norm(tool.jacobian[:3] @ body.qd))
    return Outcome(
        case=case,
        nearest=judge.nearest,
        nearest_self=judge.nearest_self,
        two=judge.two,
        part=judge.part,
        obstacle=judge.obstacle,
        at=judge.at,
        reason=reason,
        slowed=busy / max(1, ticks),
        pinched=guard.pinched,
        travelled=way,
    )


def closing(arm: ArmModel, body: Body, q: Array, which: int, around: Surroundings, whose: int) -> Array:
    """(n,) joint velocities of length 1 that bring a capsule straight to an obstacle."""
    A, B = placed(body, q)
    d = capsule_row(A[which], B[which], body.capsules[which, 7], around.rows[whose], around.vertices)
    witness, normal = A[which] + d[1] * (B[which] - A[which]), np.array(d[2:])
    rotations, origins = arm.poses(q)
    row = np.zeros(arm.n)
    for k in range(int(body.capsules[which, 0]) + 1):
        row[k] = normal @ np.cross(rotations[k] @ arm.axes[k], witness - origins[k])
    length = float(np.linalg.norm(row))
    return -row / length if length > 1e-6 else row
