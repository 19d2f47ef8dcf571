"""From a twist of the tool to joint velocities: the law that keeps the direction, with rows that it must keep.

A small quadratic program in (q', s, r), solved at every control period:

    min  L |J_lin q' - s v|^2 + 100 |J_ang q' - r w - e|^2 + S |v|^2 (1 - s)^2 + S |w|^2 (1 - r)^2
         + damping |q'|^2 + posture
    s.t. 0 <= s <= 1,  0 <= r <= 1,  low <= q' <= high,  A q' >= b

v and w are commanded, e = 4 log3(R_wanted R_tool^T) leads back to the orientation that the tool keeps. Where the arm
cannot follow it gives up speed (s, r) before it gives up direction: L = 100, S = 1. Where it shall slide along what
rows keep it off, the line may bend: L = 10, S = 100. Damping holds back what drives further into a singularity, and
not what leads out of it: there it would outweigh the speed a thousandfold, and the arm would stick (see `escape`).

An arm with more than six joints has motions that the tool does not feel: they lead home, slowly, while the tool is
told to move (`add_posture`), so that the elbow does not drift away; and to nothing while it is told to stand.

Arrays:
    limits: (4, n) lower, upper (rad), greatest velocity (rad/s), acceleration (rad/s^2), see LOWER and so on.
    home: (n,) rad.
    J: (6, n), R_tool: (3, 3) of the tool now, in base. R_wanted: (3, 3) the orientation that it keeps.
    v, w: (3,) commanded, in base (m/s, rad/s).
    low, high: (n,) the box of joint velocities (rad/s). A: (capacity, n), b: (capacity,) rows, of which m count.
"""

# mypy: allow-untyped-defs, allow-untyped-calls, allow-untyped-decorators
# numba infers the types from the arrays listed above

import numpy as np

from farhand.robot_side.kernel.jit import compiled
from farhand.robot_side.kernel.qp import BAD_INPUT, SOLVED, cholesky, finite, solve, yielding
from farhand.robot_side.kernel.rotation import rotation_vector, turn_wanted
from farhand.robot_side.kernel.singularity import SINGULAR_BELOW, escaping_damping, products

YIELDED = 4
"""Status beside those of qp.py: the rows cannot all be kept, and are missed as little as can be."""
LOWER, UPPER, MAX_VELOCITY, MAX_ACCELERATION = range(4)

ORIENTATION_GAIN = 4.0  # 1/s
ORIENTATION_WEIGHT = 100.0
LINE_WEIGHT, SPEED_WEIGHT = 100.0, 1.0
SLIDING_LINE_WEIGHT, SLIDING_SPEED_WEIGHT = 10.0, 100.0
LEAST_SPEED_WEIGHT = 1e-6
LEAST_DAMPING = 1e-8
"""In any case, so that the program is strictly convex where escaping a singularity takes all damping away."""
POSTURE_WEIGHT = 0.1
POSTURE_GAIN = 0.5
"""1/s of the way home."""
POSTURE_SPEED = 0.3
"""rad/s: no joint goes home faster."""
POSTURE_FROM = 0.05
"""m/s, or rad/s: a command slower than this leads home more slowly."""


@compiled
def joint_box(limits, q, previous, dt, low, high):
    """Fill low and high: velocity limits, braking before position limits, and acceleration, which wins.

    So the box is never empty, and no limit asks for more than the arm can do.
    """
    for i in range(q.shape[0]):
        a = limits[MAX_ACCELERATION, i]
        # u dt + u^2 / (2a) <= way left, solved for u
        up = np.sqrt((a * dt) ** 2 + 2.0 * a * max(limits[UPPER, i] - q[i], 0.0)) - a * dt
        down = a * dt - np.sqrt((a * dt) ** 2 + 2.0 * a * max(q[i] - limits[LOWER, i], 0.0))
        least, most = previous[i] - a * dt, previous[i] + a * dt
        low[i] = min(max(down, -limits[MAX_VELOCITY, i], least), most)
        high[i] = min(max(min(up, limits[MAX_VELOCITY, i]), least), most)


@compiled
def brake(low, high, qd):
    """qd = as near to standing as the box lets it be; zero where there is no box."""
    for i in range(qd.shape[0]):
        qd[i] = min(max(0.0, low[i]), high[i])
        if not np.isfinite(qd[i]):
            qd[i] = 0.0


@compiled
def along(J, qd, line):
    """The tool's velocity under joint velocities qd (n,), times a line (3,)."""
    total = 0.0
    for k in range(3):
        if line[k] != 0.0:
            moves = 0.0
            for i in range(qd.shape[0]):
                moves += J[k, i] * qd[i]
            total += line[k] * moves
    return total


@compiled
def unbounded(J, v, damping, free):
    """Fill free (n,) with the joint velocities that v (m/s) alone would take; whether J is far from singular.

    free = J'(J J' + damping I)^-1 (v, 0); far from it is where no singular value is below SINGULAR_BELOW.
    """
    M, L, y = np.empty((6, 6)), np.zeros((6, 6)), np.empty(6)
    products(J, damping, M)
    cholesky(M, L)
    for r in range(6):
        s = v[r] if r < 3 else 0.0
        for k in range(r):
            s -= L[r, k] * y[k]
        y[r] = s / L[r, r]
    for r in range(5, -1, -1):
        s = y[r]
        for k in range(r + 1, 6):
            s -= L[k, r] * y[k]
        y[r] = s / L[r, r]
    for i in range(free.shape[0]):
        free[i] = 0.0
        for k in range(6):
            free[i] += J[k, i] * y[k]
    products(J, -(SINGULAR_BELOW**2), M)
    return cholesky(M, L)


@compiled
def add_posture(J, q, home, hurry, H, f):
    """Add what leads home in the motions that the tool does not feel: POSTURE_WEIGHT |P (q' - u)|^2 to H and f.

    P projects onto them, u = hurry * POSTURE_GAIN (home - q), cut to POSTURE_SPEED.
    """
    n = q.shape[0]
    M, L, P = np.empty((6, 6)), np.zeros((6, 6)), np.empty((n, n))
    products(J, 1e-6, M)
    if not cholesky(M, L):
        return
    Y = np.empty((6, n))  # L^-1 J
    for c in range(n):
        for r in range(6):
            s = J[r, c]
            for k in range(r):
                s -= L[r, k] * Y[k, c]
            Y[r, c] = s / L[r, r]
    for i in range(n):
        for j in range(n):
            P[i, j] = 1.0 if i == j else 0.0
            for k in range(6):
                P[i, j] -= Y[k, i] * Y[k, j]
    for i in range(n):
        for j in range(n):
            u = hurry * min(max(POSTURE_GAIN * (home[j] - q[j]), -POSTURE_SPEED), POSTURE_SPEED)
            H[i, j] += POSTURE_WEIGHT * P[i, j]
            f[i] -= POSTURE_WEIGHT * P[i, j] * u


@compiled
def length(a):
    """Of a vector (3,)."""
    return np.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


@compiled
def state(q, home, J, v, w, e, sliding, H, f):
    """Fill H and f with half the program's derivatives, in (q', s, r)."""
    n = q.shape[0]
    line = SLIDING_LINE_WEIGHT if sliding else LINE_WEIGHT
    price = SLIDING_SPEED_WEIGHT if sliding else SPEED_WEIGHT
    H[:, :] = 0.0
    f[:] = 0.0
    total = np.empty(3)
    for k in range(3):
        total[k] = w[k] + e[k]
    least = LINE_WEIGHT * max(escaping_damping(J, v, total), LEAST_DAMPING)
    for i in range(n):
        for j in range(i + 1):
            one, two = 0.0, 0.0
            for k in range(3):
                one += J[k, i] * J[k, j]
                two += J[3 + k, i] * J[3 + k, j]
            H[i, j] = line * one + ORIENTATION_WEIGHT * two
            H[j, i] = H[i, j]
        H[i, i] += least
        one, two, back = 0.0, 0.0, 0.0
        for k in range(3):
            one += J[k, i] * v[k]
            two += J[3 + k, i] * w[k]
            back += J[3 + k, i] * e[k]
        H[i, n] = H[n, i] = -line * one
        f[i] = -ORIENTATION_WEIGHT * back
        if H.shape[0] > n + 1:
            H[i, n + 1] = H[n + 1, i] = -ORIENTATION_WEIGHT * two
    square, turning, twice = 0.0, 0.0, 0.0
    for k in range(3):
        square += v[k] * v[k]
        turning += w[k] * w[k]
        twice += w[k] * e[k]
    speed = price * max(square, LEAST_SPEED_WEIGHT)
    H[n, n], f[n] = line * square + speed, -speed
    if H.shape[0] > n + 1:
        speed = price * max(turning, LEAST_SPEED_WEIGHT)
        H[n + 1, n + 1] = ORIENTATION_WEIGHT * turning + speed
        f[n + 1] = ORIENTATION_WEIGHT * twice - speed
    if n > 6:
        add_posture(J, q, home, min(1.0, (length(v) + length(w)) / POSTURE_FROM), H, f)


@compiled
def velocity(q, home, J, R_tool, R_wanted, v, w, low, high, A, b, m, sliding, qd):
    """Fill qd; returns (status, share of w that is followed).

    SOLVED: as the program says. YIELDED: the rows cannot all be kept; qd misses them as little as can be in the box.
    Anything else: qd brakes.
    """
    n = q.shape[0]
    turns = w[0] != 0.0 or w[1] != 0.0 or w[2] != 0.0
    size = n + 2 if turns else n + 1
    H, f, x = np.empty((size, size)), np.empty(size), np.empty(size)
    lows, highs = np.zeros(size), np.ones(size)
    rows = np.zeros((m, size))
    multipliers = np.empty(2 * size + m)
    for j in range(m):
        for i in range(n):
            rows[j, i] = A[j, i]
    for i in range(n):
        lows[i], highs[i] = low[i], high[i]
    e = np.empty(3)
    rotation_vector(R_wanted, R_tool, e)
    for k in range(3):
        e[k] *= ORIENTATION_GAIN
    if not (finite(v) and finite(w) and finite(e)):
        brake(low, high, qd)
        return BAD_INPUT, 0.0
    state(q, home, J, v, w, e, sliding, H, f)
    status, _ = solve(H, f, lows, highs, rows, b, m, x, multipliers)
    if status == SOLVED:
        for i in range(n):
            qd[i] = x[i]
        return SOLVED, x[n + 1] if turns else 0.0
    if status != BAD_INPUT and m > 0 and yielding(A, b, m, low, high, qd)[0] == SOLVED:
        return YIELDED, 0.0
    brake(low, high, qd)
    return status, 0.0


@compiled
def tick(limits, home, q, previous, J, R_tool, R_wanted, v, w, dt, qd):
    """One control period without rows: fill qd (n,), turn R_wanted; returns the status."""
    n = q.shape[0]
    low, high = np.empty(n), np.empty(n)
    joint_box(limits, q, previous, dt, low, high)
    A, b = np.empty((0, n)), np.empty(0)
    m = A.shape[0]  # no plain 0 and False: those would be compiled in, and all else a second time
    status, share = velocity(q, home, J, R_tool, R_wanted, v, w, low, high, A, b, m, m > 0, qd)
    if share > 0.0:
        part = np.empty(3)
        for k in range(3):
            part[k] = share * w[k]
        turn_wanted(R_wanted, R_tool, part, dt)
    return status
