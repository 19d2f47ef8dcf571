"""How near an arm is to a singularity, and how plainly a motion leads out of it.

Arrays: J: (6, n) the tool's Jacobian, linear rows first. qd, right, gradient: (n,). left: (6,).
"""

# mypy: allow-untyped-defs, allow-untyped-calls, allow-untyped-decorators
# numba infers the types from the arrays listed above

import numpy as np

from farhand.robot_side.kernel.jit import compiled
from farhand.robot_side.kernel.qp import cholesky

SINGULAR_BELOW = 0.08
"""Smallest singular value of the Jacobian under which damping sets in."""
MAX_DAMPING = 0.05
PLAIN = 0.2
"""Cosine to the gradient of the smallest singular value from which a motion leads out of a singularity plainly."""


@compiled
def products(J, shift, out):
    """out (6, 6) = J J' + shift I."""
    for i in range(6):
        for j in range(i + 1):
            s = shift if i == j else 0.0
            for k in range(J.shape[1]):
                s += J[i, k] * J[j, k]
            out[i, j] = s
            out[j, i] = s


@compiled
def singular(J, left, right, way):
    """The smallest singular value of J; fills its vectors left (6,), right (n,), and `way` (n,), see below.

    One-sided Jacobi rotations of the rows of J. On entry `way` is (6,) padded to (n,): a twist; on return the joint
    velocities that do it, straight out of the singular values.
    """
    n = J.shape[1]
    W, V = np.empty((6, n)), np.zeros((6, 6))  # W = V'J, its rows orthogonal in the end
    for i in range(6):
        V[i, i] = 1.0
        for k in range(n):
            W[i, k] = J[i, k]
    for _ in range(30):
        turned = False
        for i in range(5):
            for j in range(i + 1, 6):
                a, b, c = 0.0, 0.0, 0.0
                for k in range(n):
                    a += W[i, k] * W[i, k]
                    b += W[j, k] * W[j, k]
                    c += W[i, k] * W[j, k]
                if abs(c) <= 1e-15 * np.sqrt(a * b) or abs(c) < 1e-300:
                    continue
                turned = True
                zeta = (b - a) / (2.0 * c)
                t = (1.0 if zeta >= 0.0 else -1.0) / (abs(zeta) + np.sqrt(1.0 + zeta * zeta))
                cosine = 1.0 / np.sqrt(1.0 + t * t)
                sine = cosine * t
                for k in range(n):
                    one, two = W[i, k], W[j, k]
                    W[i, k], W[j, k] = cosine * one - sine * two, sine * one + cosine * two
                for k in range(6):
                    one, two = V[k, i], V[k, j]
                    V[k, i], V[k, j] = cosine * one - sine * two, sine * one + cosine * two
        if not turned:
            break
    values = np.empty(6)
    for i in range(6):
        s = 0.0
        for k in range(n):
            s += W[i, k] * W[i, k]
        values[i] = np.sqrt(s)
        if values[i] > 0.0:
            for k in range(n):
                W[i, k] /= values[i]
    at = np.argmin(values)
    smallest = values[at]
    if smallest < 1e-9:
        complete(W, at)
    for k in range(6):
        left[k] = V[k, at]
    for k in range(n):
        right[k] = W[at, k]
    twist = np.empty(6)
    for k in range(6):
        twist[k] = way[k]
    for k in range(n):
        way[k] = 0.0
    for i in range(6):
        s = 0.0
        for k in range(6):
            s += V[k, i] * twist[k]
        s /= max(values[i], 1e-4)
        for k in range(n):
            way[k] += s * W[i, k]
    return smallest


@compiled
def complete(W, at):
    """Row `at` of W = a unit vector across the other rows, which are unit vectors across each other."""
    n = W.shape[1]
    best = -1.0
    trial = np.empty(n)
    row = np.empty(n)
    for axis in range(n):
        trial[:] = 0.0
        trial[axis] = 1.0
        for _ in range(2):
            for i in range(W.shape[0]):
                if i == at:
                    continue
                s = 0.0
                for k in range(n):
                    s += W[i, k] * trial[k]
                for k in range(n):
                    trial[k] -= s * W[i, k]
        length = 0.0
        for k in range(n):
            length += trial[k] * trial[k]
        if length > best + 1e-9:
            best = length
            for k in range(n):
                row[k] = trial[k] / np.sqrt(length)
    for k in range(n):
        W[at, k] = row[k]


@compiled
def singular_value_gradient(J, left, right, gradient):
    """Fill (n,) derivatives of the singular value with vectors left (6,), right (n,) by the joint positions.

    The value changes at left^T dJ/dt right. For revolute joints column i of J changes with joint j by (z_j x J_lin,i;
    z_j x z_i) if j <= i, else by (z_i x J_lin,j; 0), z_i = J_ang,i: so it takes nothing but J.
    """
    n = J.shape[1]
    lin, after, before = np.zeros(3), np.zeros(3), np.zeros(3)
    for i in range(n):
        for k in range(3):
            before[k] += J[3 + k, i] * right[i]
    for j in range(n - 1, -1, -1):
        for k in range(3):
            # what lies after a joint turns with it, what lies before sees the tool shifted by it
            lin[k] += J[k, j] * right[j]
            after[k] += J[3 + k, j] * right[j]
            before[k] -= J[3 + k, j] * right[j]
        total = 0.0
        for k in range(3):
            p, q = (k + 1) % 3, (k + 2) % 3
            z = J[3 + p, j] * lin[q] - J[3 + q, j] * lin[p]
            z -= J[p, j] * before[q] - J[q, j] * before[p]
            total += left[k] * z
            total += left[3 + k] * (J[3 + p, j] * after[q] - J[3 + q, j] * after[p])
        gradient[j] = total


@compiled
def escape(J, left, right, qd):
    """How plainly joint velocities lead out of a singularity: 0 (not at all, or along it) to 1.

    The cosine between qd and the gradient of the smallest singular value over PLAIN, within 0 and 1.
    """
    n = J.shape[1]
    gradient = np.empty(n)
    singular_value_gradient(J, left, right, gradient)
    along, one, two = 0.0, 0.0, 0.0
    for k in range(n):
        along += gradient[k] * qd[k]
        one += gradient[k] * gradient[k]
        two += qd[k] * qd[k]
    scale = np.sqrt(one * two)
    if scale <= 0.0:
        return 0.0
    return min(max(along / (PLAIN * scale), 0.0), 1.0)


@compiled
def damping_of(smallest):
    """0 where the arm is well conditioned, rising to MAX_DAMPING^2 where it is singular."""
    if smallest >= SINGULAR_BELOW:
        return 0.0
    return MAX_DAMPING**2 * (1.0 - (smallest / SINGULAR_BELOW) ** 2)


@compiled
def escaping_damping(J, v, w):
    """`damping_of`, taken back as far as the twist (v, w) that is wanted leads out of the singularity."""
    n = J.shape[1]
    M, L = np.empty((6, 6)), np.empty((6, 6))
    products(J, -(SINGULAR_BELOW**2), M)
    if cholesky(M, L):  # every singular value is greater
        return 0.0
    left, right, way = np.empty(6), np.empty(n), np.zeros(max(n, 6))
    for k in range(3):
        way[k], way[3 + k] = v[k], w[k]
    smallest = singular(J, left, right, way)
    return damping_of(smallest) * (1.0 - escape(J, left, right, way))
