"""Exact signed distance of a capsule to every kind of obstacle, with the witness and the way out.

A capsule is a segment a-b and a radius; a sphere has a = b. All functions give

    (distance (m), t, nx, ny, nz)

t in 0..1 is the witness, a + t (b - a), the point of the axis from which the distance is measured, and n the unit
normal from the obstacle to the capsule: moving the witness by n * e changes the distance by e. Inside an obstacle the
distance is negative and n is the shortest way out. Obstacles are convex, so that a capsule that only shifts is
never nearer than its first-order estimate; one that turns may be, by the square of its turn.

Obstacles are the rows of a `Surroundings` table; the columns are named below.
"""

# mypy: allow-untyped-defs, allow-untyped-calls, allow-untyped-decorators
# numba infers the types

import math

import numpy as np

from farhand.robot_side.kernel.convex import segment_mesh
from farhand.robot_side.kernel.jit import compiled

SPHERE, CAPSULE, BOX, PLANE, MESH = range(5)
KIND, POSITION, ROTATION, SIZE, VELOCITY, ACCELERATION, BOUNDING = 0, 1, 4, 13, 16, 19, 20
COLUMNS = 24
NOTHING = 1e6
TINY = 1e-12


@compiled
def _across(ux, uy, uz):
    """A unit vector across another one; any, where that is zero."""
    if abs(ux) <= abs(uy) and abs(ux) <= abs(uz):
        x, y, z = 0.0, uz, -uy
    elif abs(uy) <= abs(uz):
        x, y, z = -uz, 0.0, ux
    else:
        x, y, z = uy, -ux, 0.0
    length = math.sqrt(x * x + y * y + z * z)
    if length < TINY:
        return 0.0, 0.0, 1.0
    return x / length, y / length, z / length


@compiled
def segment_point(a, b, x, y, z):
    """The segment a-b to a point."""
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    square = ux * ux + uy * uy + uz * uz
    t = 0.0
    if square > 0.0:
        t = ((x - a[0]) * ux + (y - a[1]) * uy + (z - a[2]) * uz) / square
        t = min(1.0, max(0.0, t))
    dx, dy, dz = a[0] + t * ux - x, a[1] + t * uy - y, a[2] + t * uz - z
    distance = math.sqrt(dx * dx + dy * dy + dz * dz)
    if distance < TINY:
        nx, ny, nz = _across(ux, uy, uz)
        return 0.0, t, nx, ny, nz
    return distance, t, dx / distance, dy / distance, dz / distance


@compiled
def segment_segment(a, b, cx, cy, cz, ex, ey, ez):
    """The segment a-b to the segment c-e; last comes the parameter on the second."""
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    vx, vy, vz = ex - cx, ey - cy, ez - cz
    wx, wy, wz = a[0] - cx, a[1] - cy, a[2] - cz
    uu = ux * ux + uy * uy + uz * uz
    vv = vx * vx + vy * vy + vz * vz
    uv = ux * vx + uy * vy + uz * vz
    uw = ux * wx + uy * wy + uz * wz
    vw = vx * wx + vy * wy + vz * wz
    t = 0.0
    denominator = uu * vv - uv * uv
    if denominator > 1e-14 * uu * vv:
        t = min(1.0, max(0.0, (uv * vw - vv * uw) / denominator))
    elif uu > 0.0 and vv > 0.0:
        # parallel: the middle of where they run side by side, so that the witness does not jump from end to end
        at_c, at_e = -uw / uu, (uv - uw) / uu
        low, high = max(0.0, min(at_c, at_e)), min(1.0, max(at_c, at_e))
        t = min(1.0, max(0.0, 0.5 * (low + high)))
    s = (vw + t * uv) / vv if vv > 0.0 else 0.0
    if s <= 0.0 or s >= 1.0 or vv == 0.0:
        s = min(1.0, max(0.0, s))
        t = min(1.0, max(0.0, (s * uv - uw) / uu)) if uu > 0.0 else 0.0
    dx, dy, dz = wx + t * ux - s * vx, wy + t * uy - s * vy, wz + t * uz - s * vz
    distance = math.sqrt(dx * dx + dy * dy + dz * dz)
    if distance > TINY:
        return distance, t, dx / distance, dy / distance, dz / distance, s
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    length = math.sqrt(nx * nx + ny * ny + nz * nz)
    if length > TINY:
        return 0.0, t, nx / length, ny / length, nz / length, s
    if vv > uu:
        nx, ny, nz = _across(vx, vy, vz)
    else:
        nx, ny, nz = _across(ux, uy, uz)
    return 0.0, t, nx, ny, nz, s


@compiled
def _slope(a, u, half, t):
    """Half the derivative by t of the squared distance of a + t u from a box."""
    total = 0.0
    for axis in range(3):
        x = a[axis] + t * u[axis]
        if x > half[axis]:
            total += (x - half[axis]) * u[axis]
        elif x < -half[axis]:
            total += (x + half[axis]) * u[axis]
    return total


@compiled
def _through_box(a, u, half):
    """The part t0..t1 of a segment that lies in a box; t0 > t1 where it misses it."""
    t0, t1 = 0.0, 1.0
    for axis in range(3):
        if abs(u[axis]) < TINY:
            if abs(a[axis]) > half[axis]:
                return 1.0, 0.0
            continue
        p, q = (-half[axis] - a[axis]) / u[axis], (half[axis] - a[axis]) / u[axis]
        t0, t1 = max(t0, min(p, q)), min(t1, max(p, q))
    return t0, t1


@compiled
def segment_box(a, u, half):
    """The segment a, a + u to the box -half..half, all three as (3,) in the box's frame.

    Outside, the squared distance along the segment is convex and piecewise quadratic: its slope is linear between the
    instants at which a face's plane is crossed. Inside, the difference of box and segment has the faces' normals and
    those across segment and edges for its own, and the nearest of these faces is the way out.
    """
    low, high = 0.0, 1.0
    at_low, at_high = _slope(a, u, half, 0.0), _slope(a, u, half, 1.0)
    t = 0.0
    if at_low >= 0.0:
        t = 0.0
    elif at_high <= 0.0:
        t = 1.0
    else:
        for axis in range(3):
            if abs(u[axis]) < TINY:
                continue
            for side in range(2):
                plane = half[axis] if side else -half[axis]
                crossing = (plane - a[axis]) / u[axis]
                if low < crossing < high:
                    there = _slope(a, u, half, crossing)
                    if there < 0.0:
                        low, at_low = crossing, there
                    else:
                        high, at_high = crossing, there
        t = low - at_low * (high - low) / (at_high - at_low) if at_high > at_low else low
    square = 0.0
    d = np.zeros(3)
    for axis in range(3):
        x = a[axis] + t * u[axis]
        d[axis] = x - min(half[axis], max(-half[axis], x))
        square += d[axis] * d[axis]
    if square > 1e-18:
        distance = math.sqrt(square)
        return distance, t, d[0] / distance, d[1] / distance, d[2] / distance
    return _out_of_box(a, u, half)


@compiled
def _out_of_box(a, u, half):
    t0, t1 = _through_box(a, u, half)
    middle = min(1.0, max(0.0, 0.5 * (t0 + t1)))
    best, t, nx, ny, nz = -math.inf, middle, 0.0, 0.0, 1.0
    for axis in range(3):
        for side in range(2):
            sign = 1.0 if side else -1.0
            at_a, along = sign * a[axis] - half[axis], sign * u[axis]
            deep = min(at_a, at_a + along)
            if deep > best:
                best = deep
                t = 0.0 if along > TINY else (1.0 if along < -TINY else middle)
                nx, ny, nz = sign * (axis == 0), sign * (axis == 1), sign * (axis == 2)
    for axis in range(3):
        # the edge along `axis` across the segment
        cx = 0.0 if axis == 0 else (-u[2] if axis == 1 else u[1])
        cy = u[2] if axis == 0 else (0.0 if axis == 1 else -u[0])
        cz = -u[1] if axis == 0 else (u[0] if axis == 1 else 0.0)
        length = math.sqrt(cx * cx + cy * cy + cz * cz)
        if length < 1e-9:
            continue
        cx, cy, cz = cx / length, cy / length, cz / length
        at_a = cx * a[0] + cy * a[1] + cz * a[2]
        sign = 1.0 if at_a >= 0.0 else -1.0
        deep = abs(at_a) - abs(cx) * half[0] - abs(cy) * half[1] - abs(cz) * half[2]
        if deep > best + 1e-12:
            best, t = deep, middle
            nx, ny, nz = sign * cx, sign * cy, sign * cz
    return min(best, 0.0), t, nx, ny, nz


@compiled
def capsule_row(a, b, radius, row, vertices):
    """(distance, t, nx, ny, nz) of a capsule to the obstacle that a row says.

    Args:
        a, b: (3,) ends of the axis in base (m).
        radius: (m).
        row: (24,) of a Surroundings table.
        vertices: (m, 3) of all its meshes, in their own frames.
    """
    kind = int(row[KIND])
    if kind == SPHERE:
        d, t, nx, ny, nz = segment_point(a, b, row[1], row[2], row[3])
        return d - row[SIZE] - radius, t, nx, ny, nz
    if kind == PLANE:
        nx, ny, nz = row[6], row[9], row[12]
        at_a = nx * (a[0] - row[1]) + ny * (a[1] - row[2]) + nz * (a[2] - row[3])
        at_b = nx * (b[0] - row[1]) + ny * (b[1] - row[2]) + nz * (b[2] - row[3])
        return min(at_a, at_b) - radius, (0.0 if at_a <= at_b else 1.0), nx, ny, nz
    if kind == CAPSULE:
        h = row[SIZE + 1]
        zx, zy, zz = h * row[6], h * row[9], h * row[12]
        d, t, nx, ny, nz, _ = segment_segment(
            a, b, row[1] - zx, row[2] - zy, row[3] - zz, row[1] + zx, row[2] + zy, row[3] + zz
        )
        return d - row[SIZE] - radius, t, nx, ny, nz
    p, u = np.empty(3), np.empty(3)
    for i in range(3):
        p[i] = u[i] = 0.0
        for k in range(3):  # R is row-major: R.T x takes its columns
            p[i] += row[ROTATION + 3 * k + i] * (a[k] - row[POSITION + k])
            u[i] += row[ROTATION + 3 * k + i] * (b[k] - a[k])
    if kind == BOX:
        d, t, x, y, z = segment_box(p, u, row[SIZE : SIZE + 3])
    else:
        first = int(row[SIZE])
        for i in range(3):
            u[i] += p[i]
        d, t, x, y, z = segment_mesh(p, u, vertices, first, first + int(row[SIZE + 1]))
    nx = row[4] * x + row[5] * y + row[6] * z
    ny = row[7] * x + row[8] * y + row[9] * z
    nz = row[10] * x + row[11] * y + row[12] * z
    return d - radius, t, nx, ny, nz


@compiled
def distance_floor(a, b, radius, row):
    """A lower bound of capsule_row's distance, by the obstacle's bounding sphere; -1e6 for planes."""
    if row[BOUNDING] == math.inf:
        return -NOTHING
    d, _, _, _, _ = segment_point(a, b, row[1], row[2], row[3])
    return d - row[BOUNDING] - radius


@compiled
def capsule_capsule(a, b, radius, c, e, other):
    """(distance, t, s, nx, ny, nz) of two capsules; t, s: witnesses on the first and second, n towards the first."""
    d, t, nx, ny, nz, s = segment_segment(a, b, c[0], c[1], c[2], e[0], e[1], e[2])
    return d - radius - other, t, s, nx, ny, nz


@compiled
def nearest_row(a, b, radius, rows, vertices):
    """(distance, index) of the obstacle nearest to a capsule; (1e6, -1) without any."""
    best, index = NOTHING, -1
    for j in range(rows.shape[0]):
        if distance_floor(a, b, radius, rows[j]) < best:
            d = capsule_row(a, b, radius, rows[j], vertices)[0]
            if d < best:
                best, index = d, j
    return best, index
