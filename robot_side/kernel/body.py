"""An arm's capsules where its joints are, and how they move: what the guard's rows and its check share."""

# mypy: allow-untyped-defs, allow-untyped-calls, allow-untyped-decorators
# numba infers the types from the arrays that guard.py describes

import math

import numpy as np

from farhand.robot_side.kernel.chain import place, turn
from farhand.robot_side.kernel.jit import compiled

# par: distance that rows keep, distance that the check keeps (m), period, reaction (s), gain (1/s), greatest braking
# along a normal (m/s^2), share of the joints' acceleration that rows and the check count on, push outwards (m/s),
# for how long a mover may accelerate before the arm answers (s)
KEEP, CHECK, DT, REACTION, GAIN, BRAKING, ROW_SHARE, STOP_SHARE, PUSH, ANSWER = range(10)
PARAMETERS = 10
STANDS_IN = 8
"""Column of the capsules, see guard.py."""


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
def moved_at_most(R, p, R_then, p_then, reach, carriers, moved):
    """Fill `moved` (links,): how far any point of a link can have gone (m), that is within `reach` (m) of the frame of
    the joint `carriers` (links,) with which it moves; returns their sum.

    The frames were R_then and p_then, which become R and p now. A turn by an angle a moves a point by at most
    2 sin(a/2) times its distance, which is |R - R_then|_F / sqrt(2) times it.
    """
    n = R.shape[0]
    gone = np.empty(n)
    for i in range(n):
        way, turned = 0.0, 0.0
        for k in range(3):
            way += (p[i, k] - p_then[i, k]) ** 2
            p_then[i, k] = p[i, k]
            for m in range(3):
                turned += (R[i, k, m] - R_then[i, k, m]) ** 2
                R_then[i, k, m] = R[i, k, m]
        gone[i] = math.sqrt(way) + reach * math.sqrt(0.5 * turned)
    total = 0.0
    for i in range(carriers.shape[0]):
        moved[i] = gone[carriers[i]]
        total += moved[i]
    return total


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
def part_of(A, B, i, t0, t1, a, b):
    """Fill a, b with the ends of the part t0..t1 of capsule i."""
    for k in range(3):
        u = B[i, k] - A[i, k]
        a[k], b[k] = A[i, k] + t0 * u, A[i, k] + t1 * u
