"""Distance of a segment to a convex mesh given by its vertices: GJK outside, EPA inside.

Both work on the difference D = {x - v : x on the segment, v in the mesh}, a convex body whose point nearest to the
origin is the difference of the nearest points (Gilbert, Johnson, Keerthi 1988; van den Bergen 2001 for the inside).
Everything is in the mesh's frame; a result is (signed distance, parameter of the witness on the segment, unit
normal from mesh to segment).
"""

# mypy: allow-untyped-defs, allow-untyped-calls, allow-untyped-decorators
# numba infers the types

import math

import numpy as np

from farhand.robot_side.kernel.jit import compiled

GJK_ROUNDS = 64
EPA_ROUNDS = 48
_CORNERS, _FACES, _EDGES = 64, 256, 256
GAIN = 1e-10
"""Of the distance: less progress than this ends the search."""
TOUCHING = 1e-9
"""m: nearer than this GJK takes the segment as inside, and EPA decides."""


@compiled
def support(a, b, vertices, first, last, dx, dy, dz):
    """The point of D that lies farthest in a direction, and its parameter on the segment (0: a, 1: b)."""
    at_a = dx * a[0] + dy * a[1] + dz * a[2]
    at_b = dx * b[0] + dy * b[1] + dz * b[2]
    best, least = first, math.inf
    for i in range(first, last):
        along = dx * vertices[i, 0] + dy * vertices[i, 1] + dz * vertices[i, 2]
        if along < least:
            best, least = i, along
    v = vertices[best]
    if at_b > at_a:
        return b[0] - v[0], b[1] - v[1], b[2] - v[2], 1.0
    return a[0] - v[0], a[1] - v[1], a[2] - v[2], 0.0


@compiled
def _on_triangle(S, i, j, k, weights):
    """Barycentric weights of the point of a triangle nearest to the origin (Ericson, Real-Time Collision Detection)."""
    abx, aby, abz = S[j, 0] - S[i, 0], S[j, 1] - S[i, 1], S[j, 2] - S[i, 2]
    acx, acy, acz = S[k, 0] - S[i, 0], S[k, 1] - S[i, 1], S[k, 2] - S[i, 2]
    d1 = -(abx * S[i, 0] + aby * S[i, 1] + abz * S[i, 2])
    d2 = -(acx * S[i, 0] + acy * S[i, 1] + acz * S[i, 2])
    d3 = -(abx * S[j, 0] + aby * S[j, 1] + abz * S[j, 2])
    d4 = -(acx * S[j, 0] + acy * S[j, 1] + acz * S[j, 2])
    d5 = -(abx * S[k, 0] + aby * S[k, 1] + abz * S[k, 2])
    d6 = -(acx * S[k, 0] + acy * S[k, 1] + acz * S[k, 2])
    weights[:] = 0.0
    if d1 <= 0.0 and d2 <= 0.0:
        weights[i] = 1.0
        return
    if d3 >= 0.0 and d4 <= d3:
        weights[j] = 1.0
        return
    if d6 >= 0.0 and d5 <= d6:
        weights[k] = 1.0
        return
    vc = d1 * d4 - d3 * d2
    if vc <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        weights[j] = d1 / (d1 - d3)
        weights[i] = 1.0 - weights[j]
        return
    vb = d5 * d2 - d1 * d6
    if vb <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        weights[k] = d2 / (d2 - d6)
        weights[i] = 1.0 - weights[k]
        return
    va = d3 * d6 - d5 * d4
    if va <= 0.0 and d4 >= d3 and d5 >= d6:
        weights[k] = (d4 - d3) / ((d4 - d3) + (d5 - d6))
        weights[j] = 1.0 - weights[k]
        return
    total = va + vb + vc
    weights[j] = vb / total
    weights[k] = vc / total
    weights[i] = 1.0 - weights[j] - weights[k]


@compiled
def _nearest(S, count, weights):
    """Weights of the simplex's point nearest to the origin; True where a tetrahedron holds the origin."""
    weights[:] = 0.0
    if count == 1:
        weights[0] = 1.0
        return False
    if count == 2:
        ex, ey, ez = S[1, 0] - S[0, 0], S[1, 1] - S[0, 1], S[1, 2] - S[0, 2]
        length = ex * ex + ey * ey + ez * ez
        t = -(ex * S[0, 0] + ey * S[0, 1] + ez * S[0, 2]) / length if length > 0.0 else 0.0
        t = min(1.0, max(0.0, t))
        weights[0], weights[1] = 1.0 - t, t
        return False
    if count == 3:
        _on_triangle(S, 0, 1, 2, weights)
        return False
    best = math.inf
    kept = np.zeros(4)
    outside = False
    for skipped in range(4):
        i, j, k = (skipped + 1) % 4, (skipped + 2) % 4, (skipped + 3) % 4
        abx, aby, abz = S[j, 0] - S[i, 0], S[j, 1] - S[i, 1], S[j, 2] - S[i, 2]
        acx, acy, acz = S[k, 0] - S[i, 0], S[k, 1] - S[i, 1], S[k, 2] - S[i, 2]
        nx, ny, nz = aby * acz - abz * acy, abz * acx - abx * acz, abx * acy - aby * acx
        here = -(nx * S[i, 0] + ny * S[i, 1] + nz * S[i, 2])
        far = nx * (S[skipped, 0] - S[i, 0]) + ny * (S[skipped, 1] - S[i, 1]) + nz * (S[skipped, 2] - S[i, 2])
        if here * far > 0.0:
            continue
        outside = True
        _on_triangle(S, i, j, k, weights)
        square = 0.0
        for axis in range(3):
            x = weights[i] * S[i, axis] + weights[j] * S[j, axis] + weights[k] * S[k, axis]
            square += x * x
        if square < best:
            best = square
            kept[:] = weights
    weights[:] = kept
    return not outside


@compiled
def segment_mesh(a, b, vertices, first, last):
    """(distance, t, nx, ny, nz) of the segment a-b to the hull of vertices[first:last].

    Args:
        a, b: (3,) ends (m).
        vertices: (m, 3).
        first, last: which of them.
    """
    S = np.empty((4, 3))
    T = np.empty(4)
    weights = np.zeros(4)
    S[0, 0], S[0, 1], S[0, 2], T[0] = support(a, b, vertices, first, last, 1.0, 0.0, 0.0)
    count = 1
    x, y, z, t = S[0, 0], S[0, 1], S[0, 2], T[0]
    for _ in range(GJK_ROUNDS):
        square = x * x + y * y + z * z
        if square < TOUCHING * TOUCHING:
            return _inside(a, b, vertices, first, last)
        px, py, pz, pt = support(a, b, vertices, first, last, -x, -y, -z)
        if square - (x * px + y * py + z * pz) <= GAIN * square:
            break
        known = False
        for i in range(count):
            known = known or (S[i, 0] == px and S[i, 1] == py and S[i, 2] == pz)
        if known:
            break
        S[count, 0], S[count, 1], S[count, 2], T[count] = px, py, pz, pt
        count += 1
        if _nearest(S, count, weights):
            return _inside(a, b, vertices, first, last)
        nx, ny, nz, nt, kept = 0.0, 0.0, 0.0, 0.0, 0
        for i in range(count):
            if weights[i] > 0.0:
                S[kept], T[kept] = S[i], T[i]
                nx += weights[i] * S[i, 0]
                ny += weights[i] * S[i, 1]
                nz += weights[i] * S[i, 2]
                nt += weights[i] * T[i]
                kept += 1
        if nx * nx + ny * ny + nz * nz >= square:
            break
        count = kept
        x, y, z, t = nx, ny, nz, nt
    distance = math.sqrt(x * x + y * y + z * z)
    return distance, t, x / distance, y / distance, z / distance


@compiled
def _face(S, faces, normals, offsets, at, i, j, k, middle):
    """Write a face with its normal away from `middle`, a point inside; a face without area never is the nearest."""
    abx, aby, abz = S[j, 0] - S[i, 0], S[j, 1] - S[i, 1], S[j, 2] - S[i, 2]
    acx, acy, acz = S[k, 0] - S[i, 0], S[k, 1] - S[i, 1], S[k, 2] - S[i, 2]
    nx, ny, nz = aby * acz - abz * acy, abz * acx - abx * acz, abx * acy - aby * acx
    length = math.sqrt(nx * nx + ny * ny + nz * nz)
    faces[at, 0], faces[at, 1], faces[at, 2] = i, j, k
    if length < 1e-16:
        normals[at, 0], normals[at, 1], normals[at, 2], offsets[at] = 0.0, 0.0, 0.0, math.inf
        return
    nx, ny, nz = nx / length, ny / length, nz / length
    if nx * (S[i, 0] - middle[0]) + ny * (S[i, 1] - middle[1]) + nz * (S[i, 2] - middle[2]) < 0.0:
        nx, ny, nz = -nx, -ny, -nz
        faces[at, 1], faces[at, 2] = k, j
    normals[at, 0], normals[at, 1], normals[at, 2] = nx, ny, nz
    offsets[at] = nx * S[i, 0] + ny * S[i, 1] + nz * S[i, 2]


@compiled
def _tetrahedron(a, b, vertices, first, last, S, T):
    """Four points of D that span it; False where D is flat."""
    S[0, 0], S[0, 1], S[0, 2], T[0] = support(a, b, vertices, first, last, 1.0, 0.0, 0.0)
    best, found = 0.0, False
    for axis in range(6):
        sign = 1.0 if axis < 3 else -1.0
        dx, dy, dz = sign * (axis % 3 == 0), sign * (axis % 3 == 1), sign * (axis % 3 == 2)
        x, y, z, t = support(a, b, vertices, first, last, dx, dy, dz)
        away = (x - S[0, 0]) ** 2 + (y - S[0, 1]) ** 2 + (z - S[0, 2]) ** 2
        if away > best:
            best, found = away, True
            S[1, 0], S[1, 1], S[1, 2], T[1] = x, y, z, t
    if not found or best < 1e-18:
        return False
    ux, uy, uz = S[1, 0] - S[0, 0], S[1, 1] - S[0, 1], S[1, 2] - S[0, 2]
    # two directions across the first edge, both ways
    if abs(ux) <= abs(uy) and abs(ux) <= abs(uz):
        px, py, pz = 0.0, uz, -uy
    elif abs(uy) <= abs(uz):
        px, py, pz = -uz, 0.0, ux
    else:
        px, py, pz = uy, -ux, 0.0
    qx, qy, qz = uy * pz - uz * py, uz * px - ux * pz, ux * py - uy * px
    best = 0.0
    for turn in range(4):
        sign = 1.0 if turn % 2 == 0 else -1.0
        dx, dy, dz = (sign * px, sign * py, sign * pz) if turn < 2 else (sign * qx, sign * qy, sign * qz)
        x, y, z, t = support(a, b, vertices, first, last, dx, dy, dz)
        wx, wy, wz = x - S[0, 0], y - S[0, 1], z - S[0, 2]
        cx, cy, cz = uy * wz - uz * wy, uz * wx - ux * wz, ux * wy - uy * wx
        away = cx * cx + cy * cy + cz * cz
        if away > best:
            best = away
            S[2, 0], S[2, 1], S[2, 2], T[2] = x, y, z, t
    if best < 1e-24:
        return False
    wx, wy, wz = S[2, 0] - S[0, 0], S[2, 1] - S[0, 1], S[2, 2] - S[0, 2]
    nx, ny, nz = uy * wz - uz * wy, uz * wx - ux * wz, ux * wy - uy * wx
    length = math.sqrt(nx * nx + ny * ny + nz * nz)
    best = 0.0
    for turn in range(2):
        sign = 1.0 / length if turn == 0 else -1.0 / length
        x, y, z, t = support(a, b, vertices, first, last, sign * nx, sign * ny, sign * nz)
        away = abs((x - S[0, 0]) * nx + (y - S[0, 1]) * ny + (z - S[0, 2]) * nz) / length
        if away > best:
            best = away
            S[3, 0], S[3, 1], S[3, 2], T[3] = x, y, z, t
    return best > 1e-10


@compiled
def _inside(a, b, vertices, first, last):
    """As segment_mesh, where the segment meets the mesh: the shortest way out, negative (EPA).

    Grows from any tetrahedron in D. One that does not hold the origin has a face with the origin on its outer side,
    which is the nearest by signed distance, so that it grows towards the origin first.
    """
    S = np.empty((_CORNERS, 3))
    T = np.empty(_CORNERS)
    if not _tetrahedron(a, b, vertices, first, last, S, T):
        return 0.0, 0.5, 0.0, 0.0, 1.0
    faces = np.empty((_FACES, 3), dtype=np.int64)
    normals = np.empty((_FACES, 3))
    offsets = np.empty(_FACES)
    edges = np.empty((_EDGES, 2), dtype=np.int64)
    middle = np.empty(3)
    for axis in range(3):
        middle[axis] = 0.25 * (S[0, axis] + S[1, axis] + S[2, axis] + S[3, axis])
    for skipped in range(4):
        i, j, k = (skipped + 1) % 4, (skipped + 2) % 4, (skipped + 3) % 4
        _face(S, faces, normals, offsets, skipped, i, j, k, middle)
    corners, count, nearest = 4, 4, 0
    for _ in range(EPA_ROUNDS):
        nearest = 0
        for i in range(1, count):
            if offsets[i] < offsets[nearest]:
                nearest = i
        nx, ny, nz = normals[nearest]
        x, y, z, t = support(a, b, vertices, first, last, nx, ny, nz)
        if nx * x + ny * y + nz * z - offsets[nearest] < 1e-9 or corners == _CORNERS:
            break
        S[corners, 0], S[corners, 1], S[corners, 2], T[corners] = x, y, z, t
        loose, left = 0, 0
        for i in range(count):
            seen = normals[i, 0] * x + normals[i, 1] * y + normals[i, 2] * z - offsets[i] > 1e-12
            if not seen:
                faces[left], normals[left], offsets[left] = faces[i], normals[i], offsets[i]
                left += 1
                continue
            for side in range(3):
                p, q = faces[i, side], faces[i, (side + 1) % 3]
                # an edge between two faces that go is met twice, once each way
                match = -1
                for e in range(loose):
                    if edges[e, 0] == q and edges[e, 1] == p:
                        match = e
                if match >= 0:
                    loose -= 1
                    edges[match, 0], edges[match, 1] = edges[loose, 0], edges[loose, 1]
                elif loose < _EDGES:
                    edges[loose, 0], edges[loose, 1] = p, q
                    loose += 1
        count = left
        if count + loose > _FACES or loose == 0:
            break
        for e in range(loose):
            _face(S, faces, normals, offsets, count, edges[e, 0], edges[e, 1], corners, middle)
            count += 1
        corners += 1
    nearest = 0
    for i in range(1, count):
        if offsets[i] < offsets[nearest]:
            nearest = i
    nx, ny, nz = normals[nearest]
    i, j, k = faces[nearest]
    triangle = np.empty((4, 3))
    weights = np.zeros(4)
    triangle[0], triangle[1], triangle[2] = S[i], S[j], S[k]
    _on_triangle(triangle, 0, 1, 2, weights)
    t = weights[0] * T[i] + weights[1] * T[j] + weights[2] * T[k]
    # the way out is against the outer normal of D = segment - mesh
    return -max(0.0, offsets[nearest]), t, -nx, -ny, -nz
