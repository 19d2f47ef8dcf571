"""Ways out from between what moves: straight motions of a sphere that meet nothing for some time.

Rows think of one instant: they let a mover push the sphere to where no velocity keeps them all any more, while a step
to the side would have been free all along. So a velocity is only as good as what is left after it: some time later
there must still be a constant velocity under which the sphere stays clear, of what stands and of movers that keep
theirs.

v' = (u - v) / lag, its length at most a bound, turns v towards u on a straight line, so that all has a closed form:
x(t) = x + u t - e G(t), e the direction of u - v, G the integral of |u - v|.

Arrays: x, v, u: (3,) m, m/s. rows, vertices: the table of obstacles. par: see sphere_way.
"""

# mypy: allow-untyped-defs, allow-untyped-calls, allow-untyped-decorators
# numba infers the types from the arrays listed above

import math

import numpy as np

from farhand.robot_side.kernel.distance import NOTHING, VELOCITY, capsule_row, distance_floor
from farhand.robot_side.kernel.jit import compiled
from farhand.robot_side.kernel.sphere_way import (
    CHECK,
    FASTEST,
    LAG_HIGH,
    LIMIT,
    RADIUS,
    stands,
    stopping,
    way_is_clear,
)

AS_IT_IS, ESCAPE, NONE = range(3)
LEAD = 0.1
"""s, after which there must still be a way out."""
HORIZON = 2.0
"""s, for which a way out stays clear."""
NODES = 12
"""On a way, its beginning and end counted; they grow apart as it becomes straight."""
SHARES = np.array([1.0, 2.0])
"""Speeds of ways out, over the fastest mover's."""
LEAST_SPEED = 0.2
"""m/s, of them."""
STEP = 0.4
"""s, for which a step aside is kept to; then the sphere stops. Quicker ways end at a wall before the horizon."""
DIRECTIONS = np.array(
    [
        np.array([i, j, k]) / math.sqrt(i * i + j * j + k * k)
        for i in (-1, 0, 1)
        for j in (-1, 0, 1)
        for k in (-1, 0, 1)
        if i or j or k
    ]
)


@compiled
def gone(g, t, lag, limit):
    """(G, g(t)): the integral (m) of a difference of velocities that is g (m/s) now, and what is left of it.

    Args:
        g: |u - v| at the beginning (m/s).
        t: how much later (s).
    """
    straight, total = 0.0, 0.0
    if limit > 0.0 and g > limit * lag:
        straight = min(t, (g - limit * lag) / limit)
        total = g * straight - 0.5 * limit * straight * straight
        g -= limit * straight
    if lag <= 0.0:
        return total, 0.0 if t > straight else g
    decay = math.exp(-(t - straight) / lag)
    return total + lag * g * (1.0 - decay), g * decay


@compiled
def along(x, v, u, t, par, point, velocity):
    """Fill point and velocity: where the sphere is after t s under u, and how fast."""
    ex, ey, ez = u[0] - v[0], u[1] - v[1], u[2] - v[2]
    g = math.sqrt(ex * ex + ey * ey + ez * ez)
    total, left = gone(g, t, par[LAG_HIGH], par[LIMIT])
    share, rest = (total / g, left / g) if g > 1e-12 else (0.0, 0.0)
    point[0], velocity[0] = x[0] + u[0] * t - ex * share, u[0] - ex * rest
    point[1], velocity[1] = x[1] + u[1] * t - ey * share, u[1] - ey * rest
    point[2], velocity[2] = x[2] + u[2] * t - ez * share, u[2] - ez * rest


@compiled
def step_aside(x, v, u, t, lasts, par, point, velocity):
    """As `along`, but with a stop after `lasts` s."""
    if t <= lasts:
        along(x, v, u, t, par, point, velocity)
        return
    there, then = np.empty(3), np.empty(3)
    along(x, v, u, lasts, par, there, then)
    along(there, then, np.zeros(3), t - lasts, par, point, velocity)


@compiled
def clear(now, x, v, u, lasts, begin, rows, vertices, par, enough):
    """(by how much the way under u stays clear of all, and of movers, beyond what is kept (m); whether it meets what
    stands). For HORIZON s; what is nearer now must only not come nearer.

    Args:
        lasts: for how long u is kept to, then comes a stop (s).
        now: where the sphere is now (3,), m.
        x, v: where the way begins, and how fast.
        begin: when it begins (s from now).
        enough: nothing more is found out of a way that keeps less of a mover (m).
    """
    b, speed = np.empty(3), np.empty(3)
    p, q = np.empty(3), np.empty(3)
    of_all, of_movers = NOTHING, NOTHING
    first = 0.25 * max(par[LAG_HIGH], 0.02)
    growth = (HORIZON / first) ** (1.0 / (NODES - 2))
    for j in range(rows.shape[0]):
        standing = stands(rows[j])
        kept = min(par[CHECK], capsule_row(now, now, par[RADIUS], rows[j], vertices)[0] - 1e-6)
        for k in range(3):  # what stands, the rows keep off until then
            p[k] = x[k] if standing else now[k]
        t = 0.0 if begin > 0.0 and not standing else first
        while t < 1.0001 * HORIZON:
            step_aside(x, v, u, t, lasts, par, b, speed)
            # the obstacle keeps its velocity: in its frame the sphere runs from p to q
            for k in range(3):
                q[k] = b[k] - (begin + t) * rows[j, VELOCITY + k]
            if distance_floor(p, q, par[RADIUS], rows[j]) - kept < of_all:
                gap = capsule_row(p, q, par[RADIUS], rows[j], vertices)[0] - kept
                of_all = min(of_all, gap)
                if not standing:
                    of_movers = min(of_movers, gap)
                if gap < 0.0 and (standing or gap < enough):
                    return of_all, of_movers, standing
            p[:] = q
            t = t * growth if t > 0.0 else first
    return of_all, of_movers, False


@compiled
def reach(x, v, u, rows, par):
    """(index of the nearest mover that could come here within the horizon, or -1; speed of the fastest of them)."""
    nearest, index, fastest = NOTHING, -1, 0.0
    own = max(math.sqrt(v[0] ** 2 + v[1] ** 2 + v[2] ** 2), math.sqrt(u[0] ** 2 + u[1] ** 2 + u[2] ** 2))
    way = own * (LEAD + stopping(own, par[LAG_HIGH], par[LIMIT])) + par[CHECK]
    for j in range(rows.shape[0]):
        if stands(rows[j]):
            continue
        speed = math.sqrt(rows[j, VELOCITY] ** 2 + rows[j, VELOCITY + 1] ** 2 + rows[j, VELOCITY + 2] ** 2)
        floor = distance_floor(x, x, par[RADIUS], rows[j])
        if floor <= way + speed * (LEAD + HORIZON):
            fastest = max(fastest, speed)
            if floor < nearest:
                nearest, index = floor, j
    return index, fastest


SLOW = 2 + len(SHARES) * len(DIRECTIONS)
STEPS = SLOW + 2 * len(DIRECTIONS)
ALL = STEPS + len(DIRECTIONS)


@compiled
def candidate(number, u, speed, fastest, way):
    """Fill way with velocity `number` (m/s) and return for how long it is kept to (s).

    0 stands, 1 is u, then come all directions at growing speeds; from SLOW on steps aside, at twice the mover's speed
    and at the greatest; from STEPS on all directions at the greatest.
    """
    if number == 0:
        way[:] = 0.0
        return HORIZON
    if number == 1:
        way[:] = u
        return HORIZON
    tier, direction = divmod(number - 2, len(DIRECTIONS))
    share = fastest
    if number < SLOW + len(DIRECTIONS):
        share = min(fastest, max(LEAST_SPEED, SHARES[min(tier, len(SHARES) - 1)] * speed))
    for k in range(3):
        way[k] = share * DIRECTIONS[direction, k]
    return STEP if SLOW <= number < STEPS else HORIZON


@compiled
def escape(x, v, u, rows, vertices, par, held):
    """Whether u leaves a way out; else u becomes one, where there is one.

    Args:
        held: (2,) number of the way that was found last, and whether it is being followed; is changed.

    Returns:
        (AS_IT_IS, ESCAPE or NONE, index of the nearest mover). After NONE, u is what meets nothing that stands and
        keeps most from what moves, if there is any such.
    """
    index, speed = reach(x, v, u, rows, par)
    if index < 0:
        held[1] = 0
        return AS_IT_IS, index
    way, later, then = np.empty(3), np.empty(3), np.empty(3)
    along(x, v, u, LEAD, par, later, then)
    last = int(held[0])
    for number in range(-1, STEPS):  # the last one first
        lasts = candidate(last if number < 0 else number, u, speed, par[FASTEST], way)
        if clear(x, later, then, way, lasts, LEAD, rows, vertices, par, 0.0)[0] >= 0.0:
            if number >= 0:
                held[0], held[1] = number, 0
            return AS_IT_IS, index
    best, most, found, asked = -1, -NOTHING, False, u.copy()
    for number in range(ALL):
        if number == STEPS and found:
            break
        lasts = candidate(number, asked, speed, par[FASTEST], way)
        if way_is_clear(x, v, way, rows, vertices, par) >= 0:
            continue
        of_all, of_movers, blocked = clear(
            x, x, v, way, lasts, 0.0, rows, vertices, par, 0.0 if found else most
        )
        if blocked:
            continue
        if of_all >= 0.0:
            merit = -math.sqrt((way[0] - asked[0]) ** 2 + (way[1] - asked[1]) ** 2 + (way[2] - asked[2]) ** 2)
            if number == last and held[1] > 0:  # who wavers between two ways out goes neither
                best, found = number, True
                break
            if not found or merit > most:
                best, most, found = number, merit, True
        elif not found and of_movers > most:
            best, most = number, of_movers
    if best >= 0:
        candidate(best, asked, speed, par[FASTEST], u)
        held[0], held[1] = best, 1
    return ESCAPE if found else NONE, index
