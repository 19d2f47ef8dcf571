"""The compiled check of the body behind z, see body.py. All compiled code of it is in this file.

Where numba is missing the same code runs as plain Python: slower, but most obstacles are too far to be looked at.

Arrays: plan (N, 3) and velocity (3,) of the body (m/s), z (3,) and centres (n, 3) (m), velocities (n, 3) of the
obstacles (m/s), radii (n,) (m), sigmas (n,) (m^2).
"""

# mypy: allow-untyped-defs, allow-untyped-calls, allow-untyped-decorators
# numba infers the types from the arrays listed above

import math
from pathlib import Path

import numpy as np

from farhand.common.compiled import Compiler

_compiled = Compiler(Path(__file__)).where_possible

NEAR = 1e-5  # m


@_compiled
def speed(vectors, i):
    """Length of row i of (n, 3) vectors."""
    return math.sqrt(vectors[i, 0] ** 2 + vectors[i, 1] ** 2 + vectors[i, 2] ** 2)


@_compiled
def within_reach(z, first, plan, obstacles, motion, near):
    """The obstacles that a segment could come near to at all; their indices into `near`. Returns how many.

    z goes no farther than the plan is long, and the body, whose velocity is a mean of its first and of the plan's,
    trails no longer than lag times the fastest of them.
    """
    centres, velocities, radii, sigmas = obstacles
    lag, dt = motion
    travel, fastest = 0.0, first
    for i in range(plan.shape[0]):
        each = speed(plan, i)
        travel += dt * each
        fastest = max(fastest, each)
    count = 0
    for j in range(centres.shape[0]):
        gap = math.sqrt(
            (z[0] - centres[j, 0]) ** 2 + (z[1] - centres[j, 1]) ** 2 + (z[2] - centres[j, 2]) ** 2
        )
        own = speed(velocities, j)
        least = gap - travel - own * dt * plan.shape[0] - lag * (fastest + own)
        if not (least > 0.0 and least * least > radii[j] ** 2 + sigmas[j]):
            near[count] = j
            count += 1
    return count


@_compiled
def gap_of_segment(ax, ay, az, tx, ty, tz):
    """Distance (m) of an obstacle's centre to a segment: z at `a` from it, the body at a - t."""
    share = (ax * tx + ay * ty + az * tz) / max(tx * tx + ty * ty + tz * tz, 1e-12)
    share = min(max(share, 0.0), 1.0)
    return math.sqrt((ax - share * tx) ** 2 + (ay - share * ty) ** 2 + (az - share * tz) ** 2)


@_compiled
def clear_steps(z, velocity, plan, obstacles, motion):
    """How many steps of the plan pass; obstacles is (centres, velocities, radii, sigmas), motion (lag, dt)."""
    centres, velocities, radii, sigmas = obstacles
    lag, dt = motion
    kept = math.exp(-dt / lag)
    bx, by, bz = velocity[0], velocity[1], velocity[2]  # the body's velocity at the beginning of a step
    px, py, pz = z[0], z[1], z[2]  # z there
    sx, sy, sz = 0.0, 0.0, 0.0  # sum of the plan
    body = math.sqrt(bx * bx + by * by + bz * bz)
    near = np.empty(centres.shape[0], np.int64)
    count = within_reach(z, body, plan, obstacles, motion, near)
    if count == 0:
        return plan.shape[0]
    for i in range(plan.shape[0]):
        sx, sy, sz = sx + plan[i, 0], sy + plan[i, 1], sz + plan[i, 2]
        qx, qy, qz = z[0] + dt * sx, z[1] + dt * sy, z[2] + dt * sz
        cx = kept * bx + (1.0 - kept) * plan[i, 0]
        cy = kept * by + (1.0 - kept) * plan[i, 1]
        cz = kept * bz + (1.0 - kept) * plan[i, 2]
        body = math.sqrt(bx * bx + by * by + bz * bz)
        fastest = max(speed(plan, i), body)
        after = (i + 1) * dt
        for q in range(count):
            j = near[q]
            vx, vy, vz = velocities[j, 0], velocities[j, 1], velocities[j, 2]
            ox, oy, oz = centres[j, 0] + after * vx, centres[j, 1] + after * vy, centres[j, 2] + after * vz
            step = dt * (fastest + speed(velocities, j))
            least = math.sqrt(max(radii[j] ** 2 + sigmas[j] - 0.25 * step * step, 0.0)) - NEAR
            gap = gap_of_segment(qx - ox, qy - oy, qz - oz, lag * (cx - vx), lag * (cy - vy), lag * (cz - vz))
            if gap >= least:
                continue
            standing = gap_of_segment(
                px - ox, py - oy, pz - oz, lag * (kept * bx - vx), lag * (kept * by - vy), lag * (kept * bz - vz)
            )  # fmt: skip
            if not gap >= standing - NEAR:
                return i
        bx, by, bz = cx, cy, cz
        px, py, pz = qx, qy, qz
    return plan.shape[0]
