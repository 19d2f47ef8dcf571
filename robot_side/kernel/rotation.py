"""Rotations in base: from a matrix to a vector and back, and the orientation that the tool keeps.

Arrays: R: (3, 3). e, w: (3,) rad, rad/s. R_wanted: the orientation that the tool keeps, R_tool: the one that it has.
"""

# mypy: allow-untyped-defs, allow-untyped-calls, allow-untyped-decorators
# numba infers the types from the arrays listed above

import numpy as np

from farhand.robot_side.kernel.jit import compiled

LEAD = 0.1
"""rad: the wanted orientation is at most this far ahead of the tool; an arm that cannot follow must not wind it up."""


@compiled
def rotation_vector(R_to, R_from, e):
    """e = log3(R_to R_from^T): what turns R_from into R_to (rad)."""
    M = np.empty((3, 3))
    for i in range(3):
        for j in range(3):
            M[i, j] = R_to[i, 0] * R_from[j, 0] + R_to[i, 1] * R_from[j, 1] + R_to[i, 2] * R_from[j, 2]
    cosine = 0.5 * (M[0, 0] + M[1, 1] + M[2, 2] - 1.0)
    e[0], e[1], e[2] = 0.5 * (M[2, 1] - M[1, 2]), 0.5 * (M[0, 2] - M[2, 0]), 0.5 * (M[1, 0] - M[0, 1])
    sine = np.sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2])
    if sine > 1e-7:
        scale = np.arctan2(sine, cosine) / sine
        for k in range(3):
            e[k] *= scale
    elif cosine < 0.0:  # half a turn: the axis stands in the symmetric part
        k = 0
        for j in range(1, 3):
            if M[j, j] > M[k, k]:
                k = j
        length = np.sqrt(max(2.0 * (M[k, k] + 1.0), 1e-12))
        for j in range(3):
            e[j] = np.pi * (M[j, k] + (1.0 if j == k else 0.0)) / length


@compiled
def turn_by(R, e, out):
    """out = exp(e^) R (all in base); out may not be R."""
    angle = np.sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2])
    if angle < 1e-12:
        for i in range(3):
            for k in range(3):
                out[i, k] = R[i, k]
        return
    x, y, z = e[0] / angle, e[1] / angle, e[2] / angle
    c, s = np.cos(angle), np.sin(angle)
    for k in range(3):
        a, b, d = R[0, k], R[1, k], R[2, k]
        along = (1.0 - c) * (x * a + y * b + z * d)
        out[0, k] = c * a + s * (y * d - z * b) + x * along
        out[1, k] = c * b + s * (z * a - x * d) + y * along
        out[2, k] = c * d + s * (x * b - y * a) + z * along


@compiled
def turn_wanted(R_wanted, R_tool, w, dt):
    """R_wanted <- exp(w dt) R_wanted, at most LEAD ahead of the tool; w = 0 leaves it as it is, bit for bit."""
    if w[0] == 0.0 and w[1] == 0.0 and w[2] == 0.0:
        return
    turned = np.empty((3, 3))
    e = np.empty(3)
    for k in range(3):
        e[k] = w[k] * dt
    turn_by(R_wanted, e, turned)
    rotation_vector(turned, R_tool, e)
    ahead = np.sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2])
    if ahead > LEAD:
        for k in range(3):
            e[k] *= LEAD / ahead
        turn_by(R_tool, e, turned)
    for i in range(3):
        for k in range(3):
            R_wanted[i, k] = turned[i, k]
