"""The guard of an arm: rows that keep every link off every obstacle and off the others, and a check that it can stop.

For a link's capsule and an obstacle at distance d, with witness w on the link and unit normal n from the obstacle,
the distance changes by n'J(w) q' - n.v_obstacle. The row, x = d - kept distance:

    a q' >= n.v_obstacle + a_obstacle * reaction - beta(x),   a = n'J(w)

and x is less by what the joints, that move otherwise than they were told, overrun.

    x > 0:  beta = min(10 x, a_b (-r + sqrt(r^2 + 2 x / a_b)))
    x <= 0: beta = max(10 x, -0.1 m/s, and of what stands, a tenth of the witness's own speed)

a_b is a share of what the joints together can brake along n, r the reaction (one period and the lag): what the row
permits can be stopped in x. Pushing out of what stands is bounded by the link's own speed, so that an arm that stands
is asked for nothing: then q' = 0 keeps every row of obstacles that stand.

Rows think of one instant. So what the quadratic program answers is checked once more: the straight way of the joints
until they stand is followed link by link with steps that no link can use to pass an obstacle unseen (conservative
advancement), obstacles standing where they are.

Arrays:
    chain: see chain.py.
    capsules: (c, 8): joint it moves with (-1: base), ends a and b in that joint's frame (3 + 3), radius (m).
    reach: (c, n) farthest that a capsule's points can be from each joint's axis, over all configurations (m).
    pairs: (k, 2) capsules that must stay apart; slack: (k,) by how much less than `keep` they may (m).
    A, B: (c, 3) the capsules' ends in base. R, p: (n, 3, 3), (n, 3) the joints' frames in base.
    rows, vertices: the table of obstacles.
    rows_out, b_out: (capacity, n), (capacity,): rows_out q' >= b_out.
    facts: (capacity, 4): distance, capsule, obstacle or -1 - pair, speed of approach that was asked to be less (m/s).
    watched: (capacity_w, 5): capsule, obstacle or -1 - pair, t0, t1 of the capsule's part, distance now.
    par: the constants named below.
"""

# mypy: allow-untyped-defs, allow-untyped-calls, allow-untyped-decorators
# numba infers the types from the arrays listed above

import math

import numpy as np

from farhand.robot_side.kernel.chain import forward, place, turn
from farhand.robot_side.kernel.distance import (
    ACCELERATION,
    NOTHING,
    VELOCITY,
    capsule_capsule,
    capsule_row,
    distance_floor,
)
from farhand.robot_side.kernel.jit import compiled
from farhand.robot_side.kernel.qp import BAD_INPUT, SOLVED, solve, yielding
from farhand.robot_side.kernel.velocity import (
    MAX_ACCELERATION,
    YIELDED,
    brake,
    joint_box,
    turn_wanted,
    velocity,
)

# par: distance that rows keep, distance that the check keeps (m), period, reaction (s), gain (1/s), greatest braking
# along a normal (m/s^2), share of the joints' acceleration that rows and the check count on, push outwards (m/s),
# for how long a mover may accelerate before the arm answers (s)
KEEP, CHECK, DT, REACTION, GAIN, BRAKING, ROW_SHARE, STOP_SHARE, PUSH, ANSWER = range(10)
PARAMETERS = 10

PUSH_SHARE = 0.1
"""Of the witness's own speed, with which a row may push out of what stands."""
SHORT_LEVER = 0.05
"""m: of a witness that the joints hardly move, such as the foot of the upper arm over the table."""
NEAR_FOOT = 0.15
"""m: nearer than this the other half of a link whose foot is the witness has a row of its own."""
LEAST_STEP = 0.01
"""rad of the fastest joint: shorter steps of the check would only cost time."""
WORSE = 1e-4
"""m: by which what is too near already may come nearer before the check says no."""


@compiled
def frames(chain, q, R, p):
    """Fill the joints' frames at q."""
    base = np.eye(3)
    origin = np.zeros(3)
    for i in range(q.shape[0]):
        if i == 0:
            place(base, origin, chain[0], R[0], p[0])
        else:
            place(R[i - 1], p[i - 1], chain[i], R[i], p[i])
        turn(R[i], chain[i, 12:], q[i])


@compiled
def place_capsules(R, p, capsules, A, B):
    """Fill the capsules' ends in base."""
    for i in range(capsules.shape[0]):
        joint = int(capsules[i, 0])
        for k in range(3):
            if joint < 0:
                A[i, k], B[i, k] = capsules[i, 1 + k], capsules[i, 4 + k]
            else:
                A[i, k], B[i, k] = p[joint, k], p[joint, k]
                for m in range(3):
                    A[i, k] += R[joint, k, m] * capsules[i, 1 + m]
                    B[i, k] += R[joint, k, m] * capsules[i, 4 + m]


@compiled
def axes_in_base(chain, R, Z):
    """Fill the joints' axes in base (n, 3)."""
    for i in range(Z.shape[0]):
        for k in range(3):
            Z[i, k] = R[i, k, 0] * chain[i, 12] + R[i, k, 1] * chain[i, 13] + R[i, k, 2] * chain[i, 14]


@compiled
def add_row(Z, p, joint, wx, wy, wz, nx, ny, nz, sign, row):
    """row += sign n'J of the point w that moves with `joint`."""
    for i in range(joint + 1):
        x, y, z = wx - p[i, 0], wy - p[i, 1], wz - p[i, 2]
        row[i] += sign * (
            nx * (Z[i, 1] * z - Z[i, 2] * y)
            + ny * (Z[i, 2] * x - Z[i, 0] * z)
            + nz * (Z[i, 0] * y - Z[i, 1] * x)
        )


@compiled
def speed_of(Z, p, joint, wx, wy, wz, qd):
    """Speed of the point w under joint velocities qd (m/s)."""
    vx, vy, vz = 0.0, 0.0, 0.0
    for i in range(joint + 1):
        x, y, z = wx - p[i, 0], wy - p[i, 1], wz - p[i, 2]
        vx += qd[i] * (Z[i, 1] * z - Z[i, 2] * y)
        vy += qd[i] * (Z[i, 2] * x - Z[i, 0] * z)
        vz += qd[i] * (Z[i, 0] * y - Z[i, 1] * x)
    return math.sqrt(vx * vx + vy * vy + vz * vz)


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
def take_row(row, bound, low, high, fact0, fact1, fact2, rows_out, b_out, facts, count):
    """Keep a row that some velocity in the box breaks; where there are too many, those that are broken most."""
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
def part_of(A, B, i, t0, t1, a, b):
    """Fill a, b with the ends of the part t0..t1 of capsule i."""
    for k in range(3):
        u = B[i, k] - A[i, k]
        a[k], b[k] = A[i, k] + t0 * u, A[i, k] + t1 * u


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
        if joint < 0:
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
                if moves:
                    bound += nx * rows[j, VELOCITY] + ny * rows[j, VELOCITY + 1] + nz * rows[j, VELOCITY + 2]
                    bound += rows[j, ACCELERATION] * par[ANSWER]
                count = take_row(row, bound, low, high, d, i, j, rows_out, b_out, facts, count)
                if d - way < par[CHECK]:
                    watching = watch(watched, watching, i, j, t0, t1, d)
    for k in range(pairs.shape[0]):
        i, j = pairs[k, 0], pairs[k, 1]
        d, t, s, nx, ny, nz = capsule_capsule(A[i], B[i], capsules[i, 7], A[j], B[j], capsules[j, 7])
        if d + slack[k] < nearest:
            nearest, near_capsule, near_other = d + slack[k], i, -1 - k
        one, two = int(capsules[i, 0]), int(capsules[j, 0])
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
        count = take_row(row, bound, low, high, d, i, -1 - k, rows_out, b_out, facts, count)
        way = 0.0
        for m in range(
            min(one, two) + 1, n
        ):  # only the joints between two links move them against each other
            w = max(abs(low[m]), abs(high[m]))
            far = (reach[i, m] if m <= one else 0.0) + (reach[j, m] if m <= two else 0.0)
            way += far * w * (par[REACTION] + 0.5 * fastest / (par[STOP_SHARE] * acceleration[m]))
        if d - way < par[CHECK] - slack[k]:
            watching = watch(watched, watching, i, -1 - k, 0.0, 1.0, d)
    return count, watching, nearest, near_capsule, near_other


@compiled
def stop_angle(qd, acceleration, share, reaction):
    """How long the joints go on at qd, in s of that speed, until they stand: they brake together, on a straight way."""
    longest = 0.0
    for i in range(qd.shape[0]):
        longest = max(longest, abs(qd[i]) / (share * acceleration[i]))
    return reaction + 0.5 * longest


@compiled
def way_is_clear(
    chain, capsules, reach, pairs, slack, q, qd, acceleration, rows, vertices, watched, count, par
):  # fmt: skip
    """(clear, capsule, other): whether every watched part keeps the check's distance until the joints stand.

    What is too near now already must not come nearer.

    Args:
        q, qd: (n,) where the joints are, and with what they go on (rad, rad/s).
        count: of the rows of `watched`.
    """
    n, c = q.shape[0], capsules.shape[0]
    fastest = 0.0
    for i in range(n):
        fastest = max(fastest, abs(qd[i]))
    if count == 0 or fastest < 1e-9:
        return True, -1, -1
    end = stop_angle(qd, acceleration, par[STOP_SHARE], par[REACTION])
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


# what: nothing; rows changed the answer; half of the way to braking; braking; no velocity kept all rows
NOTHING_DONE, ROWS_BOUND, HALVED, BRAKING_NOW, PINCHED, BAD = range(6)
# report: what, capsule, other, distance, least distance of all, its capsule, its other, rows
WHAT, PART, OTHER, DISTANCE, NEAREST, NEAR_PART, NEAR_OTHER, ROWS = range(8)
REPORT = 8
OBEDIENT = 0.02
"""rad/s: joints that are less than this off what they are told are taken to do it."""
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
def can_stop(
    chain, capsules, reach, pairs, slack, q, qd, actual, previous, acceleration, rows, vertices,
    watched, count, par,
):  # fmt: skip
    """As way_is_clear, for joints that do what they are told, and for such that stay as far from it as they are now."""
    found = way_is_clear(
        chain, capsules, reach, pairs, slack, q, qd, acceleration, rows, vertices, watched, count, par
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
        chain, capsules, reach, pairs, slack, q, other, acceleration, rows, vertices, watched, count, par
    )


@compiled
def guarded_tick(
    chain, limits, home, capsules, reach, pairs, slack, par, rows, vertices,
    q, actual, previous, v, w, R_wanted, asked, by_law,
    R, p, R_tool, p_tool, J, rows_out, b_out, facts, watched, qd, report,
):  # fmt: skip
    """One control period under the guard: fill qd (n,), the frames and J at q, report; turn R_wanted.

    Args:
        limits, home, v, w, R_wanted: see velocity.py.
        actual: (n,) joint velocities now (rad/s).
        asked: (n,) joint velocities of another law; used where `by_law` is False.
    """
    n = q.shape[0]
    low, high = np.empty(n), np.empty(n)
    acceleration = limits[MAX_ACCELERATION]
    forward(chain, q, R, p, R_tool, p_tool, J)
    joint_box(limits, q, previous, par[DT], low, high)
    count, watching, near, near_part, near_other = find_rows(
        chain, capsules, reach, pairs, slack, R, p, rows, vertices,
        low, high, previous, actual, acceleration, par, rows_out, b_out, facts, watched,
    )  # fmt: skip
    report[WHAT], report[PART], report[OTHER], report[DISTANCE] = NOTHING_DONE, -1, -1, NOTHING
    report[NEAREST], report[NEAR_PART], report[NEAR_OTHER], report[ROWS] = near, near_part, near_other, count
    if count > 0 or watching > 0:
        # Where a stop could lead near to something the joints are asked for no more than they can do for sure, so that
        # they do as told: what they are behind with when a row first binds, they would never make good.
        for i in range(n):
            sure = par[STOP_SHARE] * acceleration[i] * par[DT]
            low[i] = min(max(low[i], previous[i] - sure), previous[i] + sure)
            high[i] = min(max(high[i], previous[i] - sure), previous[i] + sure)
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
        chain, capsules, reach, pairs, slack, q, qd, actual, previous, acceleration, rows, vertices,
        watched, watching, par,
    )  # fmt: skip
    if not clear:
        stop = np.empty(n)
        together(previous, acceleration, par[STOP_SHARE], par[DT], low, high, stop)
        for i in range(n):
            qd[i] = 0.5 * (qd[i] + stop[i])
        report[WHAT], report[PART], report[OTHER] = HALVED, part, other
        for m in range(watching):
            if watched[m, 0] == part and watched[m, 1] == other:
                report[DISTANCE] = watched[m, 4]
        clear, _, _ = can_stop(
            chain, capsules, reach, pairs, slack, q, qd, actual, previous, acceleration, rows, vertices,
            watched, watching, par,
        )  # fmt: skip
        share *= 0.5
        if not clear:
            report[WHAT] = BRAKING_NOW
            share = 0.0
            # Braking must not cost the rows: the way to a stop may lead nearer than they allow. All that the joints
            # may be able to do is asked of them now.
            joint_box(limits, q, previous, par[DT], low, high)
            given_velocity(stop, low, high, rows_out, b_out, count, qd)
    if by_law and share > 0.0:
        part_of_w = np.empty(3)
        for k in range(3):
            part_of_w[k] = share * w[k]
        turn_wanted(R_wanted, R_tool, part_of_w, par[DT])
    return status
