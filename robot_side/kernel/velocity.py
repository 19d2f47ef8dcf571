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

YIELDED = 4
"""Status beside those of qp.py: the rows cannot all be kept, and are missed as little as can be."""
LOWER, UPPER, MAX_VELOCITY, MAX_ACCELERATION = range(4)

ORIENTATION_GAIN = 4.0  # 1/s
ORIENTATION_WEIGHT = 100.0
LINE_WEIGHT, SPEED_WEIGHT = 100.0, 1.0
SLIDING_LINE_WEIGHT, SLIDING_SPEED_WEIGHT = 10.0, 100.0
LEAST_SPEED_WEIGHT = 1e-6
SINGULAR_BELOW = 0.08
"""Smallest singular value of the Jacobian under which damping sets in."""
MAX_DAMPING = 0.05
LEAST_DAMPING = 1e-8
"""In any case, so that the program is strictly convex where escaping a singularity takes all damping away."""
PLAIN = 0.2
"""Cosine to the gradient of the smallest singular value from which a motion leads out of a singularity plainly."""
LEAD = 0.1
"""rad: the wanted orientation is at most this far ahead of the tool; an arm that cannot follow must not wind it up."""
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
