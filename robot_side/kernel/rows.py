"""The guard's rows: that every link keeps off every obstacle and off the others, at this instant.

For a link's capsule and an obstacle at distance d, with witness w on the link and unit normal n from the obstacle,
the distance changes by n'J(w) q' - n.v_obstacle. The row, x = d - kept distance:

    a q' >= n.v_obstacle + a_obstacle * reaction - beta(x),   a = n'J(w)

and x is less by what the joints, that move otherwise than they were told, overrun.

    x > 0:  beta = min(10 x, a_b (-r + sqrt(r^2 + 2 x / a_b)))
    x <= 0: beta = max(10 x, -0.1 m/s, and of what stands, a tenth of the witness's own speed)

a_b is a share of what the joints together can brake along n, r the reaction (one period and the lag): what the row
permits can be stopped in x. Pushing out of what stands is bounded by the link's own speed, so that an arm that stands
is asked for nothing: then q' = 0 keeps every row of obstacles that stand.
"""

# mypy: allow-untyped-defs, allow-untyped-calls, allow-untyped-decorators
# numba infers the types from the arrays that guard.py describes

import math

import numpy as np

from farhand.robot_side.kernel.body import (
    ANSWER,
    BRAKING,
    CHECK,
    GAIN,
    KEEP,
    PUSH,
    REACTION,
    ROW_SHARE,
    STANDS_IN,
    STOP_SHARE,
    add_row,
    axes_in_base,
    part_of,
    place_capsules,
    speed_of,
)
from farhand.robot_side.kernel.distance import (
    ACCELERATION,
    NOTHING,
    VELOCITY,
    capsule_capsule,
    capsule_row,
    distance_floor,
)
from farhand.robot_side.kernel.jit import compiled

PUSH_SHARE = 0.1
"""Of the witness's own speed, with which a row may push out of what stands."""
SHORT_LEVER = 0.05
"""m: of a witness that the joints hardly move, such as the foot of the upper arm over the table."""
SPARE = 1e-6
"""m, for what sums of floats lose."""
NEAR_FOOT = 0.15
"""m: nearer than this the other half of a link whose foot is the witness has a row of its own."""


@compiled
def approach(x, braking, par):
    """beta(x) for x > 0 (m/s)."""
    r = par[REACTION]
    if braking <= 0.0:
        return 0.0
    return min(par[GAIN] * x, braking * (math.sqrt(r * r + 2.0 * x / braking) - r))


@compiled
def bound_of(x, lever, speed, moves, par):
    """-beta(x): lever is the acceleration along the normal that the joints have together (m/s^2)."""
    if x > 0.0:
        return -approach(x, min(par[BRAKING], par[ROW_SHARE] * lever), par)
    push = min(-par[GAIN] * x, par[PUSH])
    return push if moves else min(push, PUSH_SHARE * speed)


@compiled
def overrun(row, previous, actual, lever, par):
    """How much nearer the witness comes than was commanded, until the joints move as they were told (m)."""
    faster = 0.0
    for i in range(row.shape[0]):
        faster += row[i] * (previous[i] - actual[i])
    if faster <= 0.0:
        return 0.0
    braking = min(par[BRAKING], par[ROW_SHARE] * lever)
    return faster * par[REACTION] + (0.5 * faster * faster / braking if braking > 0.0 else 0.0)


@compiled
def far_off(closing, fastest, weakest, par):
    """x from which on two links need no row, by bounds that cost less than the row (m).

    For approach(x) >= closing, whatever the row: of joints whose speeds are at most `fastest` the lever times the
    acceleration is at least closing * weakest / fastest. The same bounds what `overrun` takes from x.

    Args:
        closing: fastest approach (m/s), of joints that are at most as fast as `fastest` (rad/s).
        weakest: least acceleration of a joint (rad/s^2).
    """
    r = par[REACTION]
    lag = r + 0.5 * max(closing / par[BRAKING], fastest / (par[ROW_SHARE] * weakest))
    return max(closing / par[GAIN], closing * lag) + SPARE


@compiled
def take_row(row, bound, low, high, fact0, fact1, fact2, chased, rows_out, b_out, facts, count):
    """Keep a row that some velocity in the box breaks; where there are too many, those that are broken most.

    `chased`: what of the bound is owed to the obstacle's own motion (m/s).
    """
    n = row.shape[0]
    least, most = 0.0, 0.0
    for i in range(n):
        least += min(row[i] * low[i], row[i] * high[i])
        most += max(row[i] * low[i], row[i] * high[i])
    if least >= bound:
        return count
    at = count
    if count == b_out.shape[0]:
        at = 0
        for i in range(1, count):
            if facts[i, 3] < facts[at, 3]:
                at = i
        if facts[at, 3] >= bound - least:
            return count
    else:
        count += 1
    # one that no velocity in the box keeps is kept as far as one can
    b_out[at] = min(bound, most)
    for i in range(n):
        rows_out[at, i] = row[i]
    facts[at, 0], facts[at, 1], facts[at, 2], facts[at, 3] = fact0, fact1, fact2, bound - least
    facts[at, 4] = chased
    return count


@compiled
def watch(watched, count, capsule, other, t0, t1, distance):
    """One more part to watch on the way to a stop; where there are too many, the nearest."""
    at = count
    if count == watched.shape[0]:
        at = 0
        for i in range(1, count):
            if watched[i, 4] > watched[at, 4]:
                at = i
        if watched[at, 4] <= distance:
            return count
    else:
        count += 1
    watched[at, 0], watched[at, 1], watched[at, 2], watched[at, 3] = capsule, other, t0, t1
    watched[at, 4] = distance
    return count


@compiled
def find_rows(
    chain, capsules, reach, pairs, slack, R, p, rows, vertices,
    low, high, previous, actual, acceleration, par, rows_out, b_out, facts, watched,
):  # fmt: skip
    """Fill rows_out, b_out, facts and watched; returns (rows, watched, least distance, its capsule, its other).

    Args:
        low, high: (n,) the box of joint velocities now (rad/s).
        previous, actual: (n,) commanded last, and as the joints move now (rad/s).
        acceleration: (n,) of the joints (rad/s^2).
    """
    n, c = previous.shape[0], capsules.shape[0]
    A, B, Z = np.empty((c, 3)), np.empty((c, 3)), np.empty((n, 3))
    place_capsules(R, p, capsules, A, B)
    axes_in_base(chain, R, Z)
    row = np.empty(n)
    a, b = np.empty(3), np.empty(3)
    count, watching = 0, 0
    nearest, near_capsule, near_other = NOTHING, -1, -1
    fastest = 0.0  # rad/s, of any joint
    for k in range(n):
        fastest = max(fastest, max(abs(low[k]), abs(high[k])))
    for i in range(c):
        joint = int(capsules[i, 0])
        if joint < 0 or capsules[i, STANDS_IN] > 0.0:
            continue
        radius = capsules[i, 7]
        v, way = (
            0.0,
            0.0,
        )  # m/s, the fastest that any point of the link can be; m, that it can go until it stands
        for k in range(joint + 1):
            w = max(abs(low[k]), abs(high[k]))
            v += reach[i, k] * w
            way += reach[i, k] * w * (par[REACTION] + 0.5 * fastest / (par[STOP_SHARE] * acceleration[k]))
        for j in range(rows.shape[0]):
            vo = math.sqrt(rows[j, 16] ** 2 + rows[j, 17] ** 2 + rows[j, 18] ** 2)
            vo += rows[j, ACCELERATION] * par[ANSWER]
            # A row binds only where beta is less than the speed of approach: beyond the farther of the two it is not.
            closing = v + vo
            horizon = closing / par[GAIN]
            horizon = max(horizon, closing * (par[REACTION] + 0.5 * closing / par[BRAKING]))
            horizon = max(horizon, way + vo * fastest / par[BRAKING])
            for k in range(joint + 1):
                horizon = max(
                    horizon, closing * (par[REACTION] + 0.5 * fastest / (par[ROW_SHARE] * acceleration[k]))
                )
            horizon = max(horizon, par[PUSH] / par[GAIN]) + par[KEEP]
            floor = distance_floor(A[i], B[i], radius, rows[j])
            if floor > horizon and floor > nearest:
                continue
            moves = vo > 0.0
            d, t, lever = 0.0, 0.0, 0.0
            for half in range(2):
                t0, t1 = 0.0, 1.0
                if half == 1:
                    # what the joints hardly move must not hide what they move
                    if lever >= SHORT_LEVER or d > NEAR_FOOT:
                        break
                    t0, t1 = (0.5, 1.0) if t < 0.5 else (0.0, 0.5)
                    if rows[j, 0] == 3.0:
                        t0, t1 = (1.0, 1.0) if t < 0.5 else (0.0, 0.0)
                part_of(A, B, i, t0, t1, a, b)
                d, t, nx, ny, nz = capsule_row(a, b, radius, rows[j], vertices)
                wx, wy, wz = a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])
                t = t0 + t * (t1 - t0)
                if d < nearest and half == 0:
                    nearest, near_capsule, near_other = d, i, j
                if d > horizon:
                    break
                row[:] = 0.0
                add_row(Z, p, joint, wx, wy, wz, nx, ny, nz, 1.0, row)
                along, lever = 0.0, 0.0
                for k in range(joint + 1):
                    lever += abs(row[k])
                    along += abs(row[k]) * acceleration[k]
                speed = speed_of(Z, p, joint, wx, wy, wz, previous)
                x = d - par[KEEP] - overrun(row, previous, actual, along, par)
                bound = bound_of(x, along, speed, moves, par)
                if lever < SHORT_LEVER and not moves:
                    bound = min(bound, 0.0)  # hardly movable: nothing is gained by pushing
                chased = 0.0
                if moves:
                    chased = nx * rows[j, VELOCITY] + ny * rows[j, VELOCITY + 1] + nz * rows[j, VELOCITY + 2]
                    chased += rows[j, ACCELERATION] * par[ANSWER]
                count = take_row(
                    row, bound + chased, low, high, d, i, j, chased, rows_out, b_out, facts, count
                )
                if d - way < par[CHECK]:
                    watching = watch(watched, watching, i, j, t0, t1, d)
    weakest, farthest = NOTHING, 0.0  # rad/s^2, of any joint; rad/s, off what it was told
    for k in range(n):
        weakest = min(weakest, acceleration[k])
        farthest = max(farthest, abs(previous[k] - actual[k]))
    for k in range(pairs.shape[0]):
        i, j = pairs[k, 0], pairs[k, 1]
        d, t, s, nx, ny, nz = capsule_capsule(A[i], B[i], capsules[i, 7], A[j], B[j], capsules[j, 7])
        if d + slack[k] < nearest:
            nearest, near_capsule, near_other = d + slack[k], i, -1 - k
        one, two = int(capsules[i, 0]), int(capsules[j, 0])
        way, closing, behind = 0.0, 0.0, 0.0
        for m in range(
            min(one, two) + 1, n
        ):  # only the joints between two links move them against each other
            w = max(abs(low[m]), abs(high[m]))
            far = (reach[i, m] if m <= one else 0.0) + (reach[j, m] if m <= two else 0.0)
            way += far * w * (par[REACTION] + 0.5 * fastest / (par[STOP_SHARE] * acceleration[m]))
            closing += far * w
            behind += far * abs(previous[m] - actual[m])
        if d - way < par[CHECK] - slack[k]:
            watching = watch(watched, watching, i, -1 - k, 0.0, 1.0, d)
        if d - par[KEEP] + slack[k] > far_off(closing, fastest, weakest, par) + far_off(
            behind, farthest, weakest, par
        ):
            continue
        row[:] = 0.0
        wx, wy, wz = (
            A[i, 0] + t * (B[i, 0] - A[i, 0]),
            A[i, 1] + t * (B[i, 1] - A[i, 1]),
            A[i, 2] + t * (B[i, 2] - A[i, 2]),
        )
        add_row(Z, p, one, wx, wy, wz, nx, ny, nz, 1.0, row)
        speed = speed_of(Z, p, one, wx, wy, wz, previous)
        wx, wy, wz = (
            A[j, 0] + s * (B[j, 0] - A[j, 0]),
            A[j, 1] + s * (B[j, 1] - A[j, 1]),
            A[j, 2] + s * (B[j, 2] - A[j, 2]),
        )
        add_row(Z, p, two, wx, wy, wz, nx, ny, nz, -1.0, row)
        speed += speed_of(Z, p, two, wx, wy, wz, previous)
        along = 0.0
        for m in range(n):
            along += abs(row[m]) * acceleration[m]
        x = d - par[KEEP] + slack[k] - overrun(row, previous, actual, along, par)
        bound = bound_of(x, along, speed, False, par)
        count = take_row(row, bound, low, high, d, i, -1 - k, 0.0, rows_out, b_out, facts, count)
    return count, watching, nearest, near_capsule, near_other
