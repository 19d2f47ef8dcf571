"""A small strictly convex quadratic program, by the dual active-set method of Goldfarb and Idnani (1983).

    min  1/2 x'H x + f'x   s.t.  low <= x <= high,  A x >= b

It starts at the free minimum and takes in the constraint that is violated most, until none is; each step either adds
one or drops one whose multiplier would become negative. No start is needed, and that nothing can satisfy all is found
out. Deterministic; a warm start would save nothing at this size.

Arrays:
    H: (n, n) symmetric, positive definite. f, low, high: (n,), low <= high.
    A: (capacity, n), b: (capacity,), of which the first m rows count.
    x: (n,) the answer, within the box to the last bit.
    multipliers: (2 n + m,) >= 0 of low, high and the rows, as they are given: H x + f = l_low - l_high + A'l_rows.
"""

# mypy: allow-untyped-defs, allow-untyped-calls, allow-untyped-decorators
# numba infers the types from the arrays listed above

import numpy as np

from farhand.robot_side.kernel.jit import compiled

SOLVED, INFEASIBLE, CAPPED, BAD_INPUT = range(4)
TOLERANCE = 1e-10
"""By which a constraint of unit normal may be missed while others are taken in."""
ROUNDING = 1e-15
"""The same, of the largest component of the free minimum, from which the steps start."""
ACCEPTED = 1e-7
"""By which it may be missed in the answer."""
DEPENDENT = 1e-9
"""Sine, in the metric of H^-1, under which a normal counts as one of the active ones' span."""
SMALL, SLACK = 1e-3, 100.0
"""What a joint's velocity and a row's shortfall cost in `yielding`."""


@compiled
def finite(values):
    """Whether every number of a vector is finite."""
    for value in values:
        if not np.isfinite(value):
            return False
    return True


@compiled
def cholesky(H, L):
    """Fill the lower triangle L with L L' = H; False where H is not positive definite."""
    n = H.shape[0]
    for r in range(n):
        for c in range(r + 1):
            s = H[r, c]
            for k in range(c):
                s -= L[r, k] * L[c, k]
            if c < r:
                L[r, c] = s / L[c, c]
            elif s > 0.0 and np.isfinite(s):
                L[r, r] = np.sqrt(s)
            else:
                return False
    return True


@compiled
def back_inverse(L, J):
    """J = L^-T, upper triangular."""
    n = L.shape[0]
    J[:, :] = 0.0
    for c in range(n):
        J[c, c] = 1.0 / L[c, c]
        for r in range(c - 1, -1, -1):
            s = 0.0
            for k in range(r + 1, c + 1):
                s -= L[k, r] * J[k, c]
            J[r, c] = s / L[r, r]


@compiled
def most_violated(x, low, high, A, b, m, norms, active, tolerance):
    """The number of the constraint that is missed most, by its distance, and that distance; -1: none."""
    n = x.shape[0]
    worst = tolerance
    index = -1
    for i in range(n):
        if (
            active[i] or active[n + i]
        ):  # where one side is met the other is as well, also in a box of no width
            continue
        if low[i] - x[i] > worst:
            worst, index = low[i] - x[i], i
        if x[i] - high[i] > worst:
            worst, index = x[i] - high[i], n + i
    for j in range(m):
        if active[2 * n + j] or norms[j] == 0.0:
            continue
        s = b[j]
        for k in range(n):
            s -= A[j, k] * x[k]
        s /= norms[j]
        if s > worst:
            worst, index = s, 2 * n + j
    return index, worst


@compiled
def into_frame(index, n, J, A, norms, d):
    """d = J' (unit normal of the constraint), n its length."""
    for c in range(n):
        if index < n:
            d[c] = J[index, c]
        elif index < 2 * n:
            d[c] = -J[index - n, c]
        else:
            s = 0.0
            for k in range(n):
                s += J[k, c] * A[index - 2 * n, k]
            d[c] = s / norms[index - 2 * n]


@compiled
def rotate(a, b):
    """Cosine and sine that turn (a, b) into (r, 0), and r."""
    r = np.hypot(a, b)
    if r == 0.0:
        return 1.0, 0.0, 0.0
    return a / r, b / r, r


@compiled
def take_in(J, T, d, q):
    """The constraint with frame coordinates d becomes active number q: a column more in T, J turned to it."""
    n = d.shape[0]
    for c in range(n - 1, q, -1):
        cosine, sine, d[c - 1] = rotate(d[c - 1], d[c])
        d[c] = 0.0
        for k in range(n):
            one, two = J[k, c - 1], J[k, c]
            J[k, c - 1] = cosine * one + sine * two
            J[k, c] = cosine * two - sine * one
    for k in range(q + 1):
        T[k, q] = d[k]


@compiled
def drop(J, T, q, out):
    """Active number `out` of q is dropped: its column goes, and T is triangular again."""
    n = J.shape[0]
    for c in range(out, q - 1):
        for k in range(c + 2):
            T[k, c] = T[k, c + 1]
        cosine, sine, T[c, c] = rotate(T[c, c], T[c + 1, c])
        T[c + 1, c] = 0.0
        for k in range(c + 1, q - 1):
            one, two = T[c, k + 1], T[c + 1, k + 1]
            T[c, k + 1] = cosine * one + sine * two
            T[c + 1, k + 1] = cosine * two - sine * one
        for k in range(n):
            one, two = J[k, c], J[k, c + 1]
            J[k, c] = cosine * one + sine * two
            J[k, c + 1] = cosine * two - sine * one


@compiled
def row_norms(A, b, m, norms):
    """Fill the rows' lengths, 0 where a row says nothing; False where a row cannot be met or is not finite."""
    for j in range(m):
        s = 0.0
        for k in range(A.shape[1]):
            s += A[j, k] * A[j, k]
        norms[j] = np.sqrt(s)
        if not (np.isfinite(s) and np.isfinite(b[j])):
            return False
        if norms[j] < 1e-12:
            norms[j] = 0.0
    return True


@compiled
def solve(H, f, low, high, A, b, m, x, multipliers):
    """Fill x and multipliers; returns (status, steps). What is in x is of use only where SOLVED."""
    n = x.shape[0]
    norms = np.empty(m)
    L = np.zeros((n, n))
    if not (finite(f) and finite(low) and finite(high) and row_norms(A, b, m, norms) and cholesky(H, L)):
        return BAD_INPUT, 0
    for i in range(n):
        if low[i] > high[i]:
            return INFEASIBLE, 0
    for j in range(m):
        if norms[j] == 0.0 and b[j] > TOLERANCE:
            return INFEASIBLE, 0
    J = np.empty((n, n))
    back_inverse(L, J)
    for k in range(n):  # x = -J J' f
        x[k] = 0.0
    for c in range(n):
        s = 0.0
        for k in range(c + 1):
            s += J[k, c] * f[k]
        for k in range(c + 1):
            x[k] -= J[k, c] * s
    status, steps = descend(J, low, high, A, b, m, norms, x, multipliers)
    if status != SOLVED:
        return status, steps
    for j in range(m):
        multipliers[2 * n + j] /= norms[j] if norms[j] > 0.0 else 1.0
    for i in range(n):
        x[i] = min(max(x[i], low[i]), high[i])
    for j in range(m):
        s = b[j]
        for k in range(n):
            s -= A[j, k] * x[k]
        if s > ACCEPTED * max(norms[j], 1e-3):
            return CAPPED, steps
    return SOLVED if finite(x) else BAD_INPUT, steps


@compiled
def descend(J, low, high, A, b, m, norms, x, multipliers):
    """The active-set method from the free minimum x, with J = L^-T; returns (status, steps)."""
    n = x.shape[0]
    count = 2 * n + m
    active = np.zeros(count, np.bool_)
    multipliers[:count] = 0.0
    tolerance = TOLERANCE
    for i in range(n):
        tolerance = max(tolerance, ROUNDING * abs(x[i]))
    index, missed = most_violated(x, low, high, A, b, m, norms, active, tolerance)
    if index < 0:  # nearly always: all that follows need not be made
        return SOLVED, 0
    order = np.empty(n, np.int64)
    u = np.zeros(n + 1)
    T = np.zeros((n, n))
    d = np.empty(n)
    z = np.empty(n)
    r = np.empty(n)
    q = 0
    cap = 20 * n + 4 * m
    step = 0
    while step < cap:
        u[q] = 0.0
        while step < cap:
            step += 1
            into_frame(index, n, J, A, norms, d)
            whole, free = 0.0, 0.0
            for c in range(n):
                whole += d[c] * d[c]
                if c >= q:
                    free += d[c] * d[c]
            for k in range(q - 1, -1, -1):  # r = T^-1 d: how the multipliers of the others change
                s = d[k]
                for c in range(k + 1, q):
                    s -= T[k, c] * r[c]
                r[k] = s / T[k, k]
            length, out = np.inf, -1
            for k in range(q):
                if r[k] > 0.0 and u[k] < length * r[k]:
                    length, out = u[k] / r[k], k
            moves = q < n and free > DEPENDENT * DEPENDENT * whole
            full = moves and missed / free <= length
            if full:
                length = missed / free
            elif out < 0:
                return INFEASIBLE, step
            if moves:
                for k in range(n):
                    z[k] = 0.0
                    for c in range(q, n):
                        z[k] += J[k, c] * d[c]
                    x[k] += length * z[k]
                missed -= length * free
            for k in range(q):
                u[k] = max(u[k] - length * r[k], 0.0)
            u[q] += length
            if full:
                take_in(J, T, d, q)
                active[index] = True
                order[q] = index
                q += 1
                index, missed = most_violated(x, low, high, A, b, m, norms, active, tolerance)
                if index < 0:
                    for k in range(q):
                        multipliers[order[k]] = u[k]
                    return SOLVED, step
                break
            drop(J, T, q, out)
            active[order[out]] = False
            for k in range(out, q - 1):
                order[k] = order[k + 1]
                u[k] = u[k + 1]
            u[q - 1] = u[q]
            q -= 1
    return CAPPED, step


@compiled
def yielding(A, b, m, low, high, x):
    """x in the box that misses the rows least: min 1e-3 |x|^2 + 100 |max(0, b - A x)|^2. Returns (status, steps).

    Newton's method on the rows that are missed, each step with the box kept exactly, and an exact line search.
    """
    n = x.shape[0]
    H = np.empty((n, n))
    f = np.empty(n)
    y = np.empty(n)
    spare = np.empty(2 * n)
    missed = np.empty(m, np.bool_)
    none = m - m  # a plain 0 would be compiled in, and `solve` a second time
    for i in range(n):
        x[i] = min(max(0.0, low[i]), high[i])
    for step in range(30):
        H[:, :] = 0.0
        f[:] = 0.0
        for i in range(n):
            H[i, i] = 2.0 * SMALL
        for j in range(m):
            missed[j] = shortfall(A, b, j, x) > 0.0
            if missed[j]:
                for i in range(n):
                    f[i] -= 2.0 * SLACK * b[j] * A[j, i]
                    for k in range(n):
                        H[i, k] += 2.0 * SLACK * A[j, i] * A[j, k]
        status, _ = solve(H, f, low, high, A, b, none, y, spare)
        if status != SOLVED:
            return status, step
        same = True
        for j in range(m):
            same = same and missed[j] == (shortfall(A, b, j, y) > 0.0)
        if same:
            for i in range(n):
                x[i] = y[i]
            return SOLVED, step
        least, most = 0.0, 1.0
        if slope(A, b, m, x, y, 1.0) > 0.0:
            for _ in range(50):
                middle = 0.5 * (least + most)
                if slope(A, b, m, x, y, middle) > 0.0:
                    most = middle
                else:
                    least = middle
        for i in range(n):
            x[i] += most * (y[i] - x[i])
    return SOLVED, 30


@compiled
def shortfall(A, b, j, x):
    """b_j - A_j x."""
    s = b[j]
    for k in range(x.shape[0]):
        s -= A[j, k] * x[k]
    return s


@compiled
def slope(A, b, m, x, y, t):
    """Derivative of what `yielding` seeks the least of, along y - x at x + t (y - x)."""
    total = 0.0
    for i in range(x.shape[0]):
        total += 2.0 * SMALL * (x[i] + t * (y[i] - x[i])) * (y[i] - x[i])
    for j in range(m):
        one, two = shortfall(A, b, j, x), shortfall(A, b, j, y)
        s = one + t * (two - one)
        if s > 0.0:
            total += 2.0 * SLACK * s * (two - one)
    return total
