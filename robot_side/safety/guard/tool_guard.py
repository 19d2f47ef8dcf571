"""The guard of robots that are a sphere around their tool: the free-flying box, the point, kinds from outside."""

from struct import Struct

import numpy as np

from farhand.common.geometry import Twist, Vector3
from farhand.common.messages.intervention import Intervention, deed
from farhand.robot_side.kernel.distance import ACCELERATION, COLUMNS, VELOCITY, nearest_row
from farhand.robot_side.kernel.sphere_guard import BAD, BRAKED, FREE, PINCHED, guard
from farhand.robot_side.kernel.sphere_way import (
    CHECK,
    DT,
    FASTEST,
    KAPPA,
    KEEP,
    LAG_HIGH,
    LAG_LOW,
    LIMIT,
    PARAMETERS,
    RADIUS,
    stopping,
)
from farhand.robot_side.safety.guard.crowding import Crowding
from farhand.robot_side.safety.guard.settings import GuardSettings
from farhand.robot_side.scene.surroundings import Surroundings

SPARE = 0.002
"""m, kept besides d_min for what lies between two ticks."""
DOUBT = 0.5
"""Share by which lag and acceleration may be other than they are said to be."""
RATE = 5.0
"""1/s: kappa."""
LEAST_STEP = 5e-4
"""m, on the way on which the sphere is looked ahead for."""


class ToolGuard:
    """Lets a twist through, slower, or turned aside; nothing throws.

    Args:
        settings: what is kept.
        radius: of the sphere (m).
        lag: time constant with which the tool follows a velocity (s).
        dt: control period (s).
        fastest: what it may answer with in any axis, where something moves towards it (m/s).

    Attributes:
        did: what was done to the last twist; None: nothing.
        pinched: ticks in which no velocity kept all obstacles off.
    """

    def __init__(
        self, settings: GuardSettings, radius: float, lag: float, dt: float, fastest: float = 2.0
    ) -> None:
        par = np.zeros(PARAMETERS)
        par[RADIUS], par[DT], par[KAPPA], par[FASTEST] = radius, dt, RATE, fastest
        par[KEEP], par[CHECK] = settings.d_min + SPARE, settings.d_min + 0.5 * SPARE
        par[LAG_LOW], par[LAG_HIGH] = (1.0 - DOUBT) * lag, max((1.0 + DOUBT) * lag, 2.0 * dt)
        par[LIMIT] = (1.0 - DOUBT) * settings.acceleration
        self._par = par
        self._limit = settings.d_min
        self._given, self._write = np.zeros(9), Struct("9d").pack_into
        self._u, self._facts, self._held = np.zeros(3), np.zeros(3), np.zeros(2, np.int64)
        self.did: Intervention | None = None
        self.pinched = 0
        # compiled, or loaded, now and not in the first period
        guard(self._given, np.zeros((0, COLUMNS)), np.zeros((0, 3)), par, self._held, self._u, self._facts)
        self.crowded(
            (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), Surroundings(np.zeros((0, COLUMNS)), np.zeros((0, 3)), ())
        )

    @property
    def nearest(self) -> float:
        """Least distance of the sphere to an obstacle at the last twist (m); 1e6 without any."""
        return float(self._facts[2])

    def allow(self, position: Vector3, velocity: Vector3, asked: Twist, around: Surroundings) -> Twist:
        """What of a twist the robot may do now.

        Args:
            position, velocity: of the tool (m, m/s).
            asked: what watchdog and plan let through.
            around: the obstacles now.
        """
        self._write(self._given.data, 0, *position, *velocity, *asked.linear)
        done = guard(self._given, around.rows, around.vertices, self._par, self._held, self._u, self._facts)
        self.did = None
        if done == FREE:
            return asked
        if done == BAD:
            return Twist()
        x, y, z = self._u.tolist()
        self.pinched += done == PINCHED
        self.did = self._intervention(asked.linear, (x, y, z), done == BRAKED, around)
        return Twist((x, y, z), asked.angular)

    def crowded(self, position: Vector3, velocity: Vector3, around: Surroundings) -> Crowding | None:
        """An obstacle that this could not keep the sphere off from now on; None: there is none.

        Too near is what is nearer than d_min, now or on the straight way until the robot stands.
        """
        par, speed = self._par, float(np.linalg.norm(velocity))
        way = speed * (par[DT] + stopping(speed, par[LAG_HIGH], par[LIMIT]))
        here, ahead = np.array(position), np.array(velocity) / (speed or 1.0)
        gone, now = 0.0, None
        while True:
            there = here + gone * ahead
            gap, index = nearest_row(there, there, par[RADIUS], around.rows, around.vertices)
            now = gap if now is None else now
            if gap < self._limit:
                return Crowding("tool", around.ids[index], float(now), self._limit)
            if gone >= way:
                return None
            gone = min(way, gone + max(gap - self._limit, LEAST_STEP))

    def _intervention(
        self, asked: Vector3, done: Vector3, braked: bool, around: Surroundings
    ) -> Intervention | None:
        index = int(self._facts[0])
        row = around.rows[index] if index >= 0 else np.zeros(COLUMNS)
        moves = bool(row[VELOCITY : ACCELERATION + 1].any())
        what = "braking" if braked else deed(asked, done, moves=moves)
        if what is None:
            return None
        return Intervention(
            part="tool",
            obstacle=around.ids[index] if index >= 0 else "",
            distance=float(self._facts[1]),
            limit=self._limit,
            asked=float(np.linalg.norm(asked)),
            done=float(np.linalg.norm(done)),
            what=what,
        )
