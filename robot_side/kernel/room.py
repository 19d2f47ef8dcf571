"""How near what an arm's joints can move is to obstacles: a foot may stand where it was put."""

# mypy: allow-untyped-defs, allow-untyped-calls, allow-untyped-decorators
# numba infers the types from the arrays that guard.py describes

import numpy as np

from farhand.robot_side.kernel.body import STANDS_IN, add_row, axes_in_base, frames, part_of, place_capsules
from farhand.robot_side.kernel.distance import capsule_row, distance_floor
from farhand.robot_side.kernel.jit import compiled
from farhand.robot_side.kernel.rows import SHORT_LEVER


@compiled
def room(chain, capsules, q, rows, vertices, enough, foot, near):
    """Fill `near` with the parts that are nearer than `enough` (m) to an obstacle at q; returns how many.

    A part of which the joints hardly move the nearest point is looked at without that half of it, unless that is nearer
    than `foot`.

    Args:
        q: (n,) where the joints are (rad).
        foot: (m).
        near: (capsules * obstacles, 5): capsule, obstacle, t0, t1 of the capsule's part, distance (m).
    """
    n, c = q.shape[0], capsules.shape[0]
    R, p = np.empty((n, 3, 3)), np.empty((n, 3))
    A, B, Z = np.empty((c, 3)), np.empty((c, 3)), np.empty((n, 3))
    frames(chain, q, R, p)
    place_capsules(R, p, capsules, A, B)
    axes_in_base(chain, R, Z)
    a, b, row = np.empty(3), np.empty(3), np.empty(n)
    count = 0
    for i in range(c):
        joint, radius = int(capsules[i, 0]), capsules[i, 7]
        if joint < 0 or capsules[i, STANDS_IN] > 0.0:
            continue
        for j in range(rows.shape[0]):
            if distance_floor(A[i], B[i], radius, rows[j]) >= enough:
                continue
            t0, t1 = 0.0, 1.0
            for _ in range(2):
                part_of(A, B, i, t0, t1, a, b)
                d, t, nx, ny, nz = capsule_row(a, b, radius, rows[j], vertices)
                wx, wy, wz = a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])
                row[:] = 0.0
                add_row(Z, p, joint, wx, wy, wz, nx, ny, nz, 1.0, row)
                if d < foot or np.abs(row).sum() >= SHORT_LEVER:
                    if d < enough:
                        near[count, 0], near[count, 1], near[count, 2], near[count, 3] = i, j, t0, t1
                        near[count, 4] = d
                        count += 1
                    break
                t0, t1 = (0.5, 1.0) if t < 0.5 else (0.0, 0.5)
    return count
