"""The guard of an arm, one control period: rows that keep every link off what is around it (rows.py), the velocity
control's answer under them, and a check that it can be stopped (stopping.py).

Arrays:
    chain: see chain.py.
    capsules: (c, 9): joint it moves with (-1: base), ends a and b in that joint's frame (3 + 3), radius (m), 1 for one
        that only other links are kept off, else 0.
    reach: (c, n) farthest that a capsule's points can be from each joint's axis, over all configurations (m).
    pairs: (k, 2) capsules that must stay apart; slack: (k,) by how much less than `keep` they may (m).
    A, B: (c, 3) the capsules' ends in base.
    joints: (2 n,) positions, then velocities, of the joints (rad, rad/s). placed: see chain.py.
    rows, vertices: the table of obstacles.
    rows_out, b_out: (capacity, n), (capacity,): rows_out q' >= b_out.
    facts: (capacity, 5): distance, capsule, obstacle or -1 - pair, speed of approach that was asked to be less (m/s),
        speed of approach of the obstacle itself (m/s).
    watched: (capacity_w, 5): capsule, obstacle or -1 - pair, t0, t1 of the capsule's part, distance now.
    par: the constants named below.
"""

# mypy: allow-untyped-defs, allow-untyped-calls, allow-untyped-decorators
# numba infers the types from the arrays listed above

import numpy as np

from farhand.robot_side.kernel.body import DT, KEEP, REACTION, STOP_SHARE
from farhand.robot_side.kernel.chain import forward, parts
from farhand.robot_side.kernel.distance import NOTHING
from farhand.robot_side.kernel.jit import compiled
from farhand.robot_side.kernel.qp import BAD_INPUT, SOLVED, solve, yielding
from farhand.robot_side.kernel.rotation import turn_wanted
from farhand.robot_side.kernel.rows import find_rows
from farhand.robot_side.kernel.stopping import can_stop, stop_angle, together
from farhand.robot_side.kernel.velocity import (
    LOWER,
    MAX_ACCELERATION,
    UPPER,
    YIELDED,
    brake,
    joint_box,
    velocity,
)

# what: nothing; rows changed the answer; half of the way to braking; braking; no velocity kept all rows
NOTHING_DONE, ROWS_BOUND, HALVED, BRAKING_NOW, PINCHED, BAD = range(6)
# report: what, capsule, other, distance, least distance of all, its capsule, its other, rows
WHAT, PART, OTHER, DISTANCE, NEAREST, NEAR_PART, NEAR_OTHER, ROWS = range(8)
REPORT = 8
FACTS = 5
TIGHT = 1e-6
"""m/s: a row that is kept by less than this has changed the answer."""


@compiled
def given_velocity(asked, low, high, A, b, m, qd):
    """qd = the joint velocities nearest to those that another law asks for; a status as that of `velocity`."""
    n = asked.shape[0]
    H, f, multipliers = np.eye(n), np.empty(n), np.empty(2 * n + m)
    for i in range(n):
        f[i] = -asked[i]
    status, _ = solve(H, f, low, high, A, b, m, qd, multipliers)
    if status == SOLVED:
        return SOLVED
    if status != BAD_INPUT and yielding(A, b, m, low, high, qd)[0] == SOLVED:
        return YIELDED
    brake(low, high, qd)
    return status


@compiled
def tightest(rows_out, b_out, facts, count, qd):
    """Index of the row that is tight at qd and whose distance is least; -1: none is."""
    best, at = NOTHING, -1
    for j in range(count):
        over = -b_out[j]
        for i in range(qd.shape[0]):
            over += rows_out[j, i] * qd[i]
        if over < TIGHT and facts[j, 0] < best:
            best, at = facts[j, 0], j
    return at


@compiled
def leave_for_later(b_out, facts, count, keep, soon):
    """Take movers that a link which stood would not have at `keep` (m) within `soon` (s) for such that stand.

    Fleeing from them would keep up the very speed that cannot be stopped before something else.
    """
    for j in range(count):
        chased = facts[j, 4]
        if chased > 0.0 and facts[j, 0] - keep > chased * soon:
            b_out[j] -= chased


@compiled
def ranges_that_bind(limits, facts, count):
    """Limits with the ranges that a way to a stop must keep to: none while something moves towards a part.

    Whoever flees needs all of its joints: held back at the end of a range, an arm was caught that had a way out. That
    it leaves the straight way there is the smaller harm; the joint itself stays within its range either way.
    """
    for j in range(count):
        if facts[j, 4] > 0.0:
            free = limits.copy()
            free[LOWER], free[UPPER] = -np.inf, np.inf
            return free
    return limits


@compiled
def guarded_tick(
    chain, limits, home, capsules, reach, pairs, slack, par, rows, vertices,
    joints, commanded, v, w, R_wanted, asked, by_law, known,
    placed, rows_out, b_out, facts, watched, qd, report,
):  # fmt: skip
    """One control period under the guard: fill qd (n,), `placed` but for the tool's state, report; turn R_wanted.

    Args:
        limits, home, v, w, R_wanted: see velocity.py.
        commanded: (n,) joint velocities commanded last (rad/s); may be qd.
        asked: (n,) joint velocities of another law; used where `by_law` is False.
        known: `placed` is that of these joints already.
    """
    n = commanded.shape[0]
    q, actual, previous = joints[:n], joints[n:], commanded.copy()
    R, p, R_tool, p_tool, J, _ = parts(placed, n)
    low, high = np.empty(n), np.empty(n)
    acceleration = limits[MAX_ACCELERATION]
    if not known:
        forward(chain, q, R, p, R_tool, p_tool, J)
    joint_box(limits, q, previous, par[DT], low, high)
    count, watching, near, near_part, near_other = find_rows(
        chain, capsules, reach, pairs, slack, R, p, rows, vertices,
        low, high, previous, actual, acceleration, par, rows_out, b_out, facts, watched,
    )  # fmt: skip
    report[WHAT], report[PART], report[OTHER], report[DISTANCE] = NOTHING_DONE, -1, -1, NOTHING
    report[NEAREST], report[NEAR_PART], report[NEAR_OTHER], report[ROWS] = near, near_part, near_other, count
    ranges = ranges_that_bind(limits, facts, count)
    if count > 0 or watching > 0:
        # Where a stop could lead near to something the joints are asked for no more than they can do for sure, so that
        # they do as told: what they are behind with when a row first binds, they would never make good.
        # And no joint is asked for what would bring it to the end of its range before all of them stand.
        end = stop_angle(previous, acceleration, par[STOP_SHARE], par[REACTION])
        for i in range(n):
            sure = par[STOP_SHARE] * acceleration[i] * par[DT]
            most, least = (ranges[UPPER, i] - q[i]) / end, (ranges[LOWER, i] - q[i]) / end
            low[i] = min(max(low[i], previous[i] - sure, least), previous[i] + sure)
            high[i] = min(max(min(high[i], most), previous[i] - sure), previous[i] + sure)
            high[i] = max(high[i], low[i])
    share = 0.0
    if by_law:
        status, share = velocity(
            q, home, J, R_tool, R_wanted, v, w, low, high, rows_out, b_out, count, count > 0, qd
        )
    else:
        status = given_velocity(asked, low, high, rows_out, b_out, count, qd)
    if status in (SOLVED, YIELDED):
        tight = tightest(rows_out, b_out, facts, count, qd)
        if tight >= 0:
            report[WHAT] = ROWS_BOUND if status == SOLVED else PINCHED
            report[PART], report[OTHER], report[DISTANCE] = facts[tight, 1], facts[tight, 2], facts[tight, 0]
    else:
        report[WHAT] = BAD
    clear, part, other = can_stop(
        chain, capsules, reach, pairs, slack, q, qd, actual, previous, ranges, rows, vertices,
        watched, watching, par,
    )  # fmt: skip
    if not clear:
        stop = np.empty(n)
        together(previous, acceleration, par[STOP_SHARE], par[DT], low, high, stop)
        for i in range(n):
            qd[i] = 0.5 * (qd[i] + stop[i])
        report[WHAT] = HALVED
        if part >= 0:  # else it is the end of a joint's range
            report[PART], report[OTHER] = part, other
        for m in range(watching):
            if watched[m, 0] == part and watched[m, 1] == other:
                report[DISTANCE] = watched[m, 4]
        clear, _, _ = can_stop(
            chain, capsules, reach, pairs, slack, q, qd, actual, previous, ranges, rows, vertices,
            watched, watching, par,
        )  # fmt: skip
        share *= 0.5
        if not clear:
            report[WHAT] = BRAKING_NOW
            share = 0.0
            # Braking must not cost the rows: the way to a stop may lead nearer than they allow. All that the joints
            # may be able to do is asked of them now.
            joint_box(limits, q, previous, par[DT], low, high)
            soon = stop_angle(previous, acceleration, par[STOP_SHARE], par[REACTION])
            leave_for_later(b_out, facts, count, par[KEEP], soon)
            given_velocity(stop, low, high, rows_out, b_out, count, qd)
    if by_law and share > 0.0:
        part_of_w = np.empty(3)
        for k in range(3):
            part_of_w[k] = share * w[k]
        turn_wanted(R_wanted, R_tool, part_of_w, par[DT])
    return status
