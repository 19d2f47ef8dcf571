"""The guard of a robot that is a sphere around its tool and follows velocities with a lag: rows, program, check.

For an obstacle at distance d (less what is kept) with unit normal n from it, and T at least the robot's lag:

    n'u >= n'v_o + T a_o - kappa (d + T min(0, n'(v - v_o)))

enforces psi' >= -kappa psi for psi = d' + d / T: with psi >= 0 the robot can stop in d. The obstacle's curvature only
helps, as it is convex. Where the acceleration a is bounded and w = |v - v_o| is more than it takes away in T, T
becomes (w^2 + a^2 T^2) / (2 a w), which is stopping distance over speed. What stands is never fled from: u = 0
keeps all its rows, so that the answer of min |u - u_c|^2 is no faster than u_c.

Then the straight way until it stands, after one period under u with the longest and the shortest lag, must stay clear
of all that stands; else 3/4, 1/2, 1/4 of u, then zero.

Where something moves, u must leave a way out for what comes after (escape.py); else the way out is taken.

Arrays: x, v, u_c (asked), u: (3,) m, m/s. rows, vertices: the table of obstacles. par: the constants named below.
"""

# mypy: allow-untyped-defs, allow-untyped-calls, allow-untyped-decorators
# numba infers the types from the arrays listed above

import math

import numpy as np

from farhand.robot_side.kernel.distance import ACCELERATION, NOTHING, capsule_row, distance_floor
from farhand.robot_side.kernel.escape import AS_IT_IS, ESCAPE, escape
from farhand.robot_side.kernel.jit import compiled
from farhand.robot_side.kernel.qp import SOLVED, solve, yielding
from farhand.robot_side.kernel.sphere_way import (
    FASTEST,
    KAPPA,
    KEEP,
    LAG_HIGH,
    LIMIT,
    RADIUS,
    stands,
    stopping,
    way_is_clear,
)

FREE, CHANGED, PINCHED, BRAKED, BAD = range(5)
CAPACITY = 40
SAME = 1e-9
"""m/s: an answer that differs by less is what was asked."""


@compiled
def bound(d, nv, nvo, w, acceleration, par):
    """The right side of an obstacle's row (m/s).

    Args:
        d: distance less what is kept (m).
        nv, nvo: velocities of robot and obstacle along the normal (m/s).
        w: speed of one against the other (m/s).
        acceleration: bound of the obstacle's (m/s^2); -1: it stands.
    """
    T = stopping(w, par[LAG_HIGH], par[LIMIT])
    b = nvo - par[KAPPA] * (d + T * min(0.0, nv - nvo))
    if acceleration >= 0.0:
        return b + T * acceleration
    # fled from only while the robot still moves towards it
    return min(b, max(0.0, -nv))


@compiled
def guard(given, rows, vertices, par, held, u, facts):
    """Fill u and facts; returns what was done (FREE ...).

    given: (9,) x, v and u_c.
    held: (2,) what `escape` keeps.
    facts: (3,) index of the obstacle that was decisive (-1: none), its distance, the least distance of all (m).
    """
    x, v, u_c = given[:3], given[3:6], given[6:]
    facts[0], facts[1], facts[2] = -1.0, NOTHING, NOTHING
    for k in range(3):
        u[k] = u_c[k]
        if not (math.isfinite(x[k]) and math.isfinite(v[k]) and math.isfinite(u_c[k])):
            u[:] = 0.0
            return BAD
    asked = math.sqrt(u_c[0] ** 2 + u_c[1] ** 2 + u_c[2] ** 2)
    A, b = np.empty((CAPACITY, 3)), np.empty(CAPACITY)
    which, gaps = np.empty(CAPACITY, np.int64), np.empty(CAPACITY)
    count = 0
    broken, still = False, True
    for j in range(rows.shape[0]):
        floor = distance_floor(x, x, par[RADIUS], rows[j])
        if floor > facts[2] and par[KAPPA] * (floor - par[KEEP]) > 20.0 * par[FASTEST]:
            continue
        d, _, nx, ny, nz = capsule_row(x, x, par[RADIUS], rows[j], vertices)
        facts[2] = min(facts[2], d)
        standing = stands(rows[j])
        still = still and standing
        wx, wy, wz = v[0] - rows[j, 16], v[1] - rows[j, 17], v[2] - rows[j, 18]
        nv = nx * v[0] + ny * v[1] + nz * v[2]
        nvo = nx * rows[j, 16] + ny * rows[j, 17] + nz * rows[j, 18]
        w = math.sqrt(wx * wx + wy * wy + wz * wz)
        least = bound(d - par[KEEP], nv, nvo, w, -1.0 if standing else rows[j, ACCELERATION], par)
        if least < -1.8 * par[FASTEST]:  # no answer in the box breaks it
            continue
        at = count
        if count == CAPACITY:
            at = 0
            for i in range(1, count):
                if b[i] < b[at]:
                    at = i
            if b[at] >= least:
                continue
        else:
            count += 1
        A[at, 0], A[at, 1], A[at, 2], b[at] = nx, ny, nz, least
        which[at], gaps[at] = j, d
        broken = broken or nx * u_c[0] + ny * u_c[1] + nz * u_c[2] < least
    done = FREE
    if broken:
        done = _program(u_c, A, b, count, par, u)
        decisive, most = -1, 0.0
        for i in range(count):
            missing = b[i] - (A[i, 0] * u_c[0] + A[i, 1] * u_c[1] + A[i, 2] * u_c[2])
            if missing > most:
                decisive, most = i, missing
        if decisive >= 0:
            facts[0], facts[1] = which[decisive], gaps[decisive]
    if done == CHANGED and still:
        # what it brakes with must not come on top of what was asked
        most = max(asked, math.sqrt(v[0] ** 2 + v[1] ** 2 + v[2] ** 2))
        speed = math.sqrt(u[0] ** 2 + u[1] ** 2 + u[2] ** 2)
        if speed > most:
            for k in range(3):
                u[k] *= most / speed
    if asked > 0.0 or broken:
        hit = way_is_clear(x, v, u, rows, vertices, par)
        share = 1.0
        while hit >= 0 and share > 0.0:
            share -= 0.25
            for k in range(3):
                u[k] *= share / (share + 0.25)
            facts[0] = hit
            done = BRAKED
            hit = way_is_clear(x, v, u, rows, vertices, par) if share > 0.0 else -1
        if done == BRAKED:
            facts[1] = capsule_row(x, x, par[RADIUS], rows[int(facts[0])], vertices)[0]
    left, mover = escape(x, v, u, rows, vertices, par, held)
    if left == AS_IT_IS:
        return CHANGED if done == PINCHED else done
    facts[0] = mover
    facts[1] = capsule_row(x, x, par[RADIUS], rows[mover], vertices)[0]
    return CHANGED if left == ESCAPE else PINCHED


@compiled
def _program(u_c, A, b, count, par, u):
    """u = the velocity nearest to u_c that keeps the rows; where none does, the one that misses them least."""
    H, f = np.eye(3), np.empty(3)
    low, high = np.empty(3), np.empty(3)
    multipliers = np.empty(6 + count)
    for k in range(3):
        f[k] = -u_c[k]
        high[k] = max(par[FASTEST], abs(u_c[k]))
        low[k] = -high[k]
    status, _ = solve(H, f, low, high, A, b, count, u, multipliers)
    if status == SOLVED:
        return CHANGED
    status, _ = yielding(A, b, count, low, high, u)
    if status != SOLVED:
        u[:] = 0.0
    return PINCHED
