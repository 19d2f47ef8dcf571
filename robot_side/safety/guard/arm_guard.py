"""The guard of an arm: rows for its velocity control, and a check of what that answers."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from farhand.common.geometry import Array, norm, to_vector3
from farhand.common.messages.intervention import Intervention, deed
from farhand.robot_side.arm.chain import ArmChain
from farhand.robot_side.arm.model import ArmModel
from farhand.robot_side.kernel import body as moving
from farhand.robot_side.kernel import guard as kernel
from farhand.robot_side.kernel.chain import pack
from farhand.robot_side.kernel.distance import ACCELERATION, COLUMNS, VELOCITY, capsule_capsule
from farhand.robot_side.kernel.qp import SOLVED
from farhand.robot_side.kernel.room import room
from farhand.robot_side.kernel.stopping import can_stop, together
from farhand.robot_side.kernel.velocity import MAX_ACCELERATION, YIELDED
from farhand.robot_side.safety.guard.crowding import Crowding
from farhand.robot_side.safety.guard.settings import GuardSettings
from farhand.robot_side.scene.surroundings import Surroundings

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


@dataclass(frozen=True, slots=True)
class Body:
    """The arm as the compiled code reads it; arrays are described in robot_side/kernel/guard.py.

    Attributes:
        parts: link of each capsule; those that only stand in for a link come last.
    """

    chain: Array
    capsules: Array
    reach: Array
    pairs: NDArray[np.int64]
    slack: Array
    parts: tuple[str, ...]

    @property
    def whole(self) -> int:
        """How many capsules hold their link: the first ones."""
        return len(self.capsules) - int(self.capsules[:, moving.STANDS_IN].sum())


def body_of(arm: ArmModel, keep: float) -> Body:
    """An arm's body; `keep` (m) is what the guard wants between its links.

    Links that are nearer to each other at home, as their capsules are thicker than they, may stay as near.
    """
    chain = pack(arm.R_parent_joint, arm.p_parent_joint, arm.axes, arm.R_last_tool, arm.p_last_tool)
    shapes = (*arm.capsules, *arm.stand_ins)
    capsules = np.zeros((len(shapes), 9))
    capsules[len(arm.capsules) :, moving.STANDS_IN] = 1.0
    reach = np.zeros((len(shapes), arm.n))
    lengths = np.linalg.norm(arm.p_parent_joint, axis=1)
    for i, each in enumerate(shapes):
        capsules[i, : moving.STANDS_IN] = (each.joint, *each.a, *each.b, each.radius)
        out = max(float(np.linalg.norm(each.a)), float(np.linalg.norm(each.b))) + each.radius
        for k in range(each.joint):
            reach[i, k] = out + lengths[k + 1 : each.joint + 1].sum()
        if each.joint >= 0:
            axis = arm.axes[each.joint]
            off = [float(np.linalg.norm(np.cross(axis, end))) for end in (each.a, each.b)]
            reach[i, each.joint] = max(off) + each.radius
    last = len(arm.capsules) - 1
    stood_in = tuple((i if i >= 0 else last - i, j if j >= 0 else last - j) for i, j in arm.stand_in_pairs)
    pairs = np.array(arm.self_pairs + stood_in, dtype=np.int64).reshape(-1, 2)
    body = Body(chain, capsules, reach, pairs, np.zeros(len(pairs)), tuple(c.part for c in shapes))
    gaps = self_gaps(body, arm.home)
    body.slack[:] = np.maximum(0.0, keep - gaps)
    return body


def self_gaps(body: Body, q: Array) -> Array:
    """(k,) distances of the pairs' capsules at joint positions q (m)."""
    A, B = placed(body, q)
    gaps = [
        capsule_capsule(A[i], B[i], body.capsules[i, 7], A[j], B[j], body.capsules[j, 7])[0]
        for i, j in body.pairs
    ]
    return np.array(gaps)


def placed(body: Body, q: Array) -> tuple[Array, Array]:
    """Ends (c, 3) and (c, 3) of the capsules in base at joint positions q (m)."""
    n = len(q)
    R, p = np.empty((n, 3, 3)), np.empty((n, 3))
    A, B = np.empty((len(body.capsules), 3)), np.empty((len(body.capsules), 3))
    moving.frames(body.chain, q, R, p)
    moving.place_capsules(R, p, body.capsules, A, B)
    return A, B


class Joints(NamedTuple):
    """Attributes:
    q, qd: (n,) positions and velocities now (rad, rad/s).
    commanded: (n,) velocities commanded last (rad/s).
    """

    q: Array
    qd: Array
    commanded: Array


class ArmGuard:
    """Takes the place of the velocity control's tick, with rows and a check of its own. Nothing throws.

    Args:
        arm: its model.
        settings: what is kept.
        lag: with which the joints answer (s).
        dt: control period (s).

    Attributes:
        body: the arm as the compiled code reads it.
        did: what was done in the last period; None: nothing.
        nearest: least distance of a part that moves to an obstacle or another part then (m); 1e6 without any near.
        pinched: periods in which no velocity kept all rows.
        braked: periods in which what was asked could not be stopped in time.
        failures: periods in which the velocity control had no answer; the arm brakes then.
    """

    def __init__(self, arm: ArmModel, settings: GuardSettings, lag: float, dt: float) -> None:
        par = np.zeros(moving.PARAMETERS)
        self._limit = settings.d_min
        par[moving.KEEP] = settings.d_min + SPARE_OF_ROWS
        par[moving.CHECK] = settings.d_min + SPARE_OF_CHECK
        par[moving.DT], par[moving.REACTION] = dt, dt + LAG_DOUBT * lag
        par[moving.GAIN], par[moving.BRAKING] = GAIN, BRAKING
        par[moving.ROW_SHARE], par[moving.STOP_SHARE] = ROW_SHARE, STOP_SHARE
        par[moving.PUSH], par[moving.ANSWER] = PUSH, ANSWER
        self.body = body_of(arm, par[moving.KEEP])
        self._par = par
        self._limits = np.array([arm.lower, arm.upper, arm.max_velocity, arm.max_acceleration])
        self._home = np.ascontiguousarray(arm.home, dtype=float)
        n = arm.n
        self._own_chain, self._J = ArmChain(arm), np.zeros((6, n))
        self._A, self._b = np.zeros((ROWS, n)), np.zeros(ROWS)
        self._facts, self._watched = np.zeros((ROWS, kernel.FACTS)), np.zeros((WATCHED, 5))
        self._qd, self._nothing_asked = np.zeros(n), np.zeros(n)
        self._report = np.zeros(kernel.REPORT)
        self.did: Intervention | None = None
        self.nearest = 1e6
        self.pinched = self.braked = self.failures = 0
        # compiled, or loaded, now and not in the first period
        nothing = Surroundings(np.zeros((0, COLUMNS)), np.zeros((0, 3)), ())
        still, upright = np.zeros(n), np.ascontiguousarray(arm.tool_pose(arm.home)[0])
        self.command(Joints(self._home, still, still), np.zeros(3), np.zeros(3), upright, nothing)
        self.crowded(Joints(self._home, still, still), nothing)

    def command(
        self,
        joints: Joints,
        v: Array,
        w: Array,
        R_base_wanted: Array,
        around: Surroundings,
        asked: Array | None = None,
        placed: ArmChain | None = None,
    ) -> Array:
        """Joint velocities to command now (n,), rad/s; the array is the same at every call.

        Args:
            joints: as they are, and as they were told last; that may be the array that this returned.
            v, w: (3,) commanded twist of the tool, in base (m/s, rad/s).
            R_base_wanted: (3, 3) orientation that the tool keeps; is turned by as much of w as is followed.
            around: the obstacles now.
            asked: (n,) joint velocities of another velocity control, to be changed as little as can be; None: the
                direction-keeping law decides.
            placed: the arm's kinematics at `joints`, where they are known already.
        """
        body, report = self.body, self._report
        chain = self._own_chain if placed is None else placed
        if placed is None:
            chain.q[:], chain.qd[:] = joints.q, joints.qd
        self._J = chain.tool.jacobian
        by_law = asked is None
        status = kernel.guarded_tick(
            body.chain, self._limits, self._home, body.capsules, body.reach, body.pairs, body.slack, self._par,
            around.rows, around.vertices, chain.joints, joints.commanded, v, w, R_base_wanted,
            self._nothing_asked if asked is None else asked, by_law, placed is not None, chain.placed,
            self._A, self._b, self._facts, self._watched, self._qd, report,
        )  # fmt: skip
        said = report.tolist()
        what, self.nearest = said[kernel.WHAT], said[kernel.NEAREST]
        self.failures += status not in (SOLVED, YIELDED)
        self.pinched += what == kernel.PINCHED
        self.braked += what in (kernel.HALVED, kernel.BRAKING_NOW)
        self.did = self._intervention(int(what), v, around) if said[kernel.PART] >= 0 else None
        return self._qd

    def crowded(self, joints: Joints, around: Surroundings) -> Crowding | None:
        """A part and an obstacle of which this could not keep one off the other from now on; None: there are none.

        Too near is what is nearer than d_min to a part that moves, and what the joints would come to before they stand.
        """
        body, par, acceleration = self.body, self._par, self._limits[MAX_ACCELERATION]
        speeds = np.maximum(np.abs(joints.qd), np.abs(joints.commanded)) + np.abs(
            joints.qd - joints.commanded
        )
        longest = float((speeds / (par[moving.STOP_SHARE] * acceleration)).max())
        way = float((body.reach @ speeds).max()) * (par[moving.REACTION] + 0.5 * longest)
        near = np.zeros((len(body.parts) * len(around.ids), 5))
        enough = par[moving.CHECK] + way
        count = room(
            body.chain, body.capsules, joints.q, around.rows, around.vertices, enough, self._limit, near
        )
        worst = int(np.argmin(near[:count, 4])) if count else -1
        if worst < 0 or near[worst, 4] >= self._limit:
            clear, part, other = can_stop(
                body.chain, body.capsules, body.reach, body.pairs, body.slack, joints.q, joints.commanded, joints.qd,
                joints.commanded, self._limits, around.rows, around.vertices, near, count, par,
            )  # fmt: skip
            if clear or part < 0:
                return None
            worst = next(k for k in range(count) if (near[k, 0], near[k, 1]) == (part, other))
        part, other = int(near[worst, 0]), int(near[worst, 1])
        return Crowding(body.parts[part], around.ids[other], float(near[worst, 4]), self._limit)

    def halt(self, previous: Array) -> Array:
        """Joint velocities with which the joints brake together, on the way that was checked (n,), rad/s."""
        par, limits = self._par, self._limits
        most = limits[MAX_ACCELERATION] * par[moving.DT]
        together(
            previous,
            limits[MAX_ACCELERATION],
            1.0,
            par[moving.DT],
            previous - most,
            previous + most,
            self._qd,
        )
        self.did = None
        return self._qd

    def _intervention(self, what: int, v: Array, around: Surroundings) -> Intervention | None:
        report, parts = self._report, self.body.parts
        other = int(report[kernel.OTHER])
        if other >= 0:
            name, moves = around.ids[other], bool(around.rows[other, VELOCITY : ACCELERATION + 1].any())
        else:
            name, moves = parts[self.body.pairs[-1 - other, 1]], False
        asked, done = to_vector3(v.tolist()), to_vector3((self._J[:3] @ self._qd).tolist())
        said = "braking" if what in (kernel.HALVED, kernel.BRAKING_NOW) else deed(asked, done, moves=moves)
        if said is None:
            return None
        return Intervention(
            part=parts[int(report[kernel.PART])],
            obstacle=name,
            distance=float(report[kernel.DISTANCE]),
            limit=self._limit,
            asked=norm(asked),
            done=norm(done),
            what=said,
        )
