"""The guard of an arm: rows for its velocity control, and a check of what that answers."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from farhand.common.geometry import Array
from farhand.common.messages.intervention import Intervention
from farhand.robot_side.arm.model import ArmModel
from farhand.robot_side.kernel import guard as kernel
from farhand.robot_side.kernel.chain import pack
from farhand.robot_side.kernel.qp import yielding
from farhand.robot_side.safety.guard.settings import GuardSettings
from farhand.robot_side.surroundings import Surroundings

ROWS = 40
"""More than these cannot bind at once; the ones that are broken most are kept."""
WATCHED = 192
SPARE_OF_ROWS, SPARE_OF_CHECK = 0.003, 0.002
"""m, kept besides d_min for what lies between two ticks."""
LAG_DOUBT = 1.5
"""The arm answers this much later than it is said to, at the most."""
GAIN = 10.0  # 1/s
BRAKING = 3.0  # m/s^2
ROW_SHARE, STOP_SHARE = 0.3, 0.5
PUSH = 0.1  # m/s
ANSWER = 0.1  # s

Propose = Callable[[Array, Array, int], "Array | None"]
"""Joint velocities (n,) in the box that keep rows A (m, n) q' >= b (m,), of which the first m count; None: none do."""


@dataclass(frozen=True, slots=True)
class Body:
    """The arm as the compiled code reads it; arrays are described in robot_side/kernel/guard.py."""

    chain: Array
    capsules: Array
    reach: Array
    pairs: Array
    slack: Array
    parts: tuple[str, ...]


def body_of(arm: ArmModel, keep: float) -> Body:
    """An arm's body; `keep` (m) is what the guard wants between its links.

    Links that are nearer to each other at home, as their capsules are thicker than they, may stay as near.
    """
    chain = pack(arm.R_parent_joint, arm.p_parent_joint, arm.axes, arm.R_last_tool, arm.p_last_tool)
    capsules = np.zeros((len(arm.capsules), 8))
    reach = np.zeros((len(arm.capsules), arm.n))
    lengths = np.linalg.norm(arm.p_parent_joint, axis=1)
    for i, each in enumerate(arm.capsules):
        capsules[i] = (each.joint, *each.a, *each.b, each.radius)
        out = max(float(np.linalg.norm(each.a)), float(np.linalg.norm(each.b))) + each.radius
        for k in range(each.joint):
            reach[i, k] = out + lengths[k + 1 : each.joint + 1].sum()
        if each.joint >= 0:
            axis = arm.axes[each.joint]
            off = [float(np.linalg.norm(np.cross(axis, end))) for end in (each.a, each.b)]
            reach[i, each.joint] = max(off) + each.radius
    pairs = np.array(arm.self_pairs, dtype=np.int64).reshape(-1, 2)
    body = Body(chain, capsules, reach, pairs, np.zeros(len(pairs)), tuple(c.part for c in arm.capsules))
    gaps = self_gaps(body, arm.home)
    body.slack[:] = np.maximum(0.0, keep - gaps)
    return body


def self_gaps(body: Body, q: Array) -> Array:
    """(k,) distances of the pairs' capsules at joint positions q (m)."""
    A, B = placed(body, q)
    gaps = [
        kernel.capsule_capsule(A[i], B[i], body.capsules[i, 7], A[j], B[j], body.capsules[j, 7])[0]
        for i, j in body.pairs
    ]
    return np.array(gaps)


def placed(body: Body, q: Array) -> tuple[Array, Array]:
    """Ends (c, 3) and (c, 3) of the capsules in base at joint positions q (m)."""
    n = len(q)
    R, p = np.empty((n, 3, 3)), np.empty((n, 3))
    A, B = np.empty((len(body.capsules), 3)), np.empty((len(body.capsules), 3))
    kernel.frames(body.chain, q, R, p)
    kernel.place_capsules(R, p, body.capsules, A, B)
    return A, B


class ArmGuard:
    """Args:
        arm: its model.
        settings: what is kept.
        lag: with which the joints answer (s).
        dt: control period (s).

    Attributes:
        did: what was done in the last period; None: nothing.
        nearest: least distance of any moving part to an obstacle or another part then (m).
        pinched: periods in which no velocity kept all rows.
        braked: periods in which what was asked could not be stopped in time.
    """

    def __init__(self, arm: ArmModel, settings: GuardSettings, lag: float, dt: float) -> None:
        par = np.zeros(kernel.PARAMETERS)
        par[kernel.KEEP] = settings.d_min + SPARE_OF_ROWS
        par[kernel.CHECK] = settings.d_min + SPARE_OF_CHECK
        par[kernel.DT], par[kernel.REACTION] = dt, dt + LAG_DOUBT * lag
        par[kernel.GAIN], par[kernel.BRAKING] = GAIN, BRAKING
        par[kernel.ROW_SHARE], par[kernel.STOP_SHARE] = ROW_SHARE, STOP_SHARE
        par[kernel.PUSH], par[kernel.ANSWER] = PUSH, ANSWER
        self._par = par
        self.body = body_of(arm, par[kernel.KEEP])
        self._acceleration = np.ascontiguousarray(arm.max_acceleration)
        n = arm.n
        self._R, self._p = np.empty((n, 3, 3)), np.empty((n, 3))
        self._A, self._b = np.zeros((ROWS, n)), np.zeros(ROWS)
        self._facts, self._watched = np.zeros((ROWS, 4)), np.zeros((WATCHED, 5))
        self._brake, self._none = np.zeros(n), np.zeros(n)
        self.did: Intervention | None = None
        self.nearest = 1e6
        self.pinched = self.braked = 0
        self._blame: tuple[int, int, float] | None = None

    def command(
        self, q: Array, previous: Array, low: Array, high: Array, around: Surroundings, propose: Propose
    ) -> Array:
        """Joint velocities to command now (n,), rad/s.

        Args:
            q: (n,) joint positions (rad).
            previous: (n,) commanded last (rad/s).
            low, high: (n,) the box that limits and acceleration leave (rad/s).
            around: the obstacles now.
            propose: the velocity control, to be asked with rows.
        """
        body, par = self.body, self._par
        kernel.frames(body.chain, q, self._R, self._p)
        found = kernel.find_rows(
            body.chain, body.capsules, body.reach, body.pairs, body.slack, self._R, self._p,
            around.rows, around.vertices, low, high, previous, self._acceleration, par,
            self._A, self._b, self._facts, self._watched,
        )  # fmt: skip
        count, watched, self.nearest = found[0], found[1], found[2]
        self._blame = None
        qd = propose(self._A, self._b, count)
        if qd is None:
            self.pinched += 1
            qd = np.zeros(len(q))
            yielding(self._A, self._b, count, low, high, qd)
        return self._stoppable(q, qd, previous, low, high, around, watched)

    def _stoppable(
        self,
        q: Array,
        qd: Array,
        previous: Array,
        low: Array,
        high: Array,
        around: Surroundings,
        watched: int,
    ) -> Array:
        """The velocities, or half of the way to them, or those that brake."""
        clear, capsule, other = self._clear(q, qd, around, watched)
        if clear:
            return qd
        self.braked += 1
        self._blame = (capsule, other, 0.0)
        kernel.together(
            previous, self._acceleration, STOP_SHARE, self._par[kernel.DT], low, high, self._brake
        )
        half: Array = 0.5 * (qd + self._brake)
        if self._clear(q, half, around, watched)[0]:
            return half
        return self._brake.copy()

    def _clear(self, q: Array, qd: Array, around: Surroundings, watched: int) -> tuple[bool, int, int]:
        body = self.body
        clear, capsule, other = kernel.way_is_clear(
            body.chain, body.capsules, body.reach, body.pairs, body.slack, q, qd, self._acceleration,
            around.rows, around.vertices, self._watched, watched, self._par,
        )  # fmt: skip
        return bool(clear), int(capsule), int(other)
