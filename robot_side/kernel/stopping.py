"""The guard's check that the joints can stop: rows think of one instant, this of the way until they stand.

The straight way of the joints until they stand is followed link by link with steps that no link can use to pass an
obstacle unseen (conservative advancement), obstacles standing where they are.
"""

# mypy: allow-untyped-defs, allow-untyped-calls, allow-untyped-decorators
# numba infers the types from the arrays that guard.py describes

import numpy as np

from farhand.robot_side.kernel.body import CHECK, REACTION, STOP_SHARE, frames, part_of, place_capsules
from farhand.robot_side.kernel.distance import capsule_capsule, capsule_row, distance_floor
from farhand.robot_side.kernel.jit import compiled
from farhand.robot_side.kernel.velocity import LOWER, MAX_ACCELERATION, UPPER

LEAST_STEP = 0.01
"""rad of the fastest joint: shorter steps of the check would only cost time."""
WORSE = 1e-4
"""m: by which what is too near already may come nearer before the check says no."""
OBEDIENT = 0.02
"""rad/s: joints that are less than this off what they are told are taken to do it."""


@compiled
def stop_angle(qd, acceleration, share, reaction):
    """How long the joints go on at qd, in s of that speed, until they stand: they brake together, on a straight way."""
    longest = 0.0
    for i in range(qd.shape[0]):
        longest = max(longest, abs(qd[i]) / (share * acceleration[i]))
    return reaction + 0.5 * longest


@compiled
def way_is_clear(
    chain, capsules, reach, pairs, slack, q, qd, limits, rows, vertices, watched, count, par
):  # fmt: skip
    """(clear, capsule, other): whether every watched part keeps the check's distance until the joints stand.

    What is too near now already must not come nearer. A way that goes beyond a joint's range is none, for there that
    joint brakes sooner than the others, and all of them go elsewhere; capsule and other are -1 then.

    Args:
        q, qd: (n,) where the joints are, and with what they go on (rad, rad/s).
        limits: see velocity.py.
        count: of the rows of `watched`.
    """
    n, c = q.shape[0], capsules.shape[0]
    fastest = 0.0
    for i in range(n):
        fastest = max(fastest, abs(qd[i]))
    if count == 0 or fastest < 1e-9:
        return True, -1, -1
    end = stop_angle(qd, limits[MAX_ACCELERATION], par[STOP_SHARE], par[REACTION])
    for i in range(n):
        at_last = q[i] + end * qd[i]
        if (qd[i] > 0.0 and at_last > limits[UPPER, i]) or (qd[i] < 0.0 and at_last < limits[LOWER, i]):
            return False, -1, -1
    least = LEAST_STEP / fastest
    R, p = np.empty((n, 3, 3)), np.empty((n, 3))
    A, B = np.empty((c, 3)), np.empty((c, 3))
    a, b, there = np.empty(3), np.empty(3), np.empty(n)
    gap = np.empty(count)
    speed = np.empty(count)
    for m in range(count):
        i, j = int(watched[m, 0]), int(watched[m, 1])
        k = -1 - j
        limit = par[CHECK] - (slack[k] if j < 0 else 0.0)
        gap[m] = min(limit, watched[m, 4] - WORSE)  # the distance that it keeps
        speed[m] = 0.0
        one = int(capsules[i, 0])
        two = int(capsules[pairs[k, 1], 0]) if j < 0 else -1
        for joint in range(n):
            if j < 0:
                if joint > min(one, two):
                    far = (reach[i, joint] if joint <= one else 0.0) + (
                        reach[pairs[k, 1], joint] if joint <= two else 0.0
                    )
                    speed[m] += far * abs(qd[joint])
            elif joint <= one:
                speed[m] += reach[i, joint] * abs(qd[joint])
    s = 0.0
    for m in range(count):  # the first step: from the distances that are known
        if watched[m, 4] - gap[m] <= 0.0:
            s = 0.0
            break
        free = (watched[m, 4] - gap[m]) / speed[m] if speed[m] > 0.0 else end
        s = free if m == 0 else min(s, free)
    s = min(max(s, least), end)
    while True:
        for i in range(n):
            there[i] = q[i] + s * qd[i]
        frames(chain, there, R, p)
        place_capsules(R, p, capsules, A, B)
        step = end
        for m in range(count):
            if speed[m] == 0.0:
                continue
            i, j = int(watched[m, 0]), int(watched[m, 1])
            if j < 0:
                k = pairs[-1 - j, 1]
                d = capsule_capsule(A[i], B[i], capsules[i, 7], A[k], B[k], capsules[k, 7])[0]
            else:
                part_of(A, B, i, watched[m, 2], watched[m, 3], a, b)
                free = gap[m] + speed[m] * (end - s)
                d = distance_floor(a, b, capsules[i, 7], rows[j])
                if d < free:
                    d = capsule_row(a, b, capsules[i, 7], rows[j], vertices)[0]
            if d < gap[m]:
                return False, i, j
            step = min(step, (d - gap[m]) / speed[m])
        if s >= end:
            return True, -1, -1
        s = min(s + max(step, least), end)


@compiled
def together(previous, acceleration, share, dt, low, high, out):
    """Fill `out` with the next velocities of joints that brake together, on the straight way that was checked."""
    longest = 0.0
    n = previous.shape[0]
    for i in range(n):
        longest = max(longest, abs(previous[i]) / (share * acceleration[i]))
    left = max(0.0, 1.0 - dt / longest) if longest > 0.0 else 0.0
    for i in range(n):
        out[i] = min(high[i], max(low[i], left * previous[i]))


@compiled
def can_stop(
    chain, capsules, reach, pairs, slack, q, qd, actual, previous, limits, rows, vertices,
    watched, count, par,
):  # fmt: skip
    """As way_is_clear, for joints that do what they are told, and for such that stay as far from it as they are now."""
    found = way_is_clear(
        chain, capsules, reach, pairs, slack, q, qd, limits, rows, vertices, watched, count, par
    )
    if not found[0]:
        return found
    n = q.shape[0]
    off, other = 0.0, np.empty(n)
    for i in range(n):
        off = max(off, abs(actual[i] - previous[i]))
        other[i] = qd[i] + actual[i] - previous[i]
    if off < OBEDIENT:
        return found
    return way_is_clear(
        chain, capsules, reach, pairs, slack, q, other, limits, rows, vertices, watched, count, par
    )
