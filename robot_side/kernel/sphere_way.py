"""The way of a sphere until it stands, and the numbers that a guard of spheres works with.

Arrays: x, v, u: (3,) m, m/s. rows, vertices: the table of obstacles. par: the constants named below.
"""

# mypy: allow-untyped-defs, allow-untyped-calls, allow-untyped-decorators
# numba infers the types from the arrays listed above

import math

import numpy as np

from farhand.robot_side.kernel.distance import ACCELERATION, VELOCITY, capsule_row, distance_floor
from farhand.robot_side.kernel.jit import compiled

# par: radius of the sphere, distances that rows and check keep (m), period, shortest and longest lag (s), bound of the
# acceleration (m/s^2; 0: none), kappa (1/s), fastest answer in any axis (m/s)
RADIUS, KEEP, CHECK, DT, LAG_LOW, LAG_HIGH, LIMIT, KAPPA, FASTEST = range(9)
PARAMETERS = 9


@compiled
def stopping(speed, lag, limit):
    """Stopping distance over speed (s): of a robot with that lag, and that bound of its acceleration."""
    if limit <= 0.0 or speed <= limit * lag:
        return lag
    return (speed * speed + limit * limit * lag * lag) / (2.0 * limit * speed)


@compiled
def way_is_clear(x, v, u, rows, vertices, par):
    """Index of the standing obstacle that the robot could meet before it stands; -1: none."""
    a, b = np.empty(3), np.empty(3)
    for extreme in range(2):
        lag = par[LAG_HIGH] if extreme else par[LAG_LOW]
        decay = math.exp(-par[DT] / lag) if lag > 0.0 else 0.0
        speed = 0.0
        most = 1.0
        if par[LIMIT] > 0.0:
            change = 0.0
            for k in range(3):
                change += ((1.0 - decay) * (u[k] - v[k])) ** 2
            change = math.sqrt(change)
            if change > par[LIMIT] * par[DT]:
                most = par[LIMIT] * par[DT] / change
        for k in range(3):
            b[k] = v[k] + most * (1.0 - decay) * (u[k] - v[k])
            a[k] = x[k] + 0.5 * par[DT] * (v[k] + b[k])
            speed += b[k] * b[k]
        T = stopping(math.sqrt(speed), par[LAG_HIGH], par[LIMIT])
        for k in range(3):
            b[k] = a[k] + T * b[k]
        for j in range(rows.shape[0]):
            if not stands(rows[j]) or distance_floor(a, b, par[RADIUS], rows[j]) >= par[CHECK]:
                continue
            if capsule_row(a, b, par[RADIUS], rows[j], vertices)[0] >= par[CHECK]:
                continue
            # what is too near now already must only not come nearer
            here = capsule_row(x, x, par[RADIUS], rows[j], vertices)[0]
            there = capsule_row(b, b, par[RADIUS], rows[j], vertices)[0]
            if here >= par[CHECK] or there < here - 1e-6:
                return j
    return -1


@compiled
def stands(row):
    """Whether an obstacle has no velocity, and will have none."""
    return (
        row[VELOCITY] == 0.0
        and row[VELOCITY + 1] == 0.0
        and row[VELOCITY + 2] == 0.0
        and row[ACCELERATION] == 0.0
    )
