"""Whether a plan for z = x + lag v keeps the body x clear: what operator_side/margins/lag.py leaves to rare paths.

At every instant the body heads for z. If z stopped now, the body would run along the segment from x to z, and no
nearer to anything than that segment. So a plan is followed as far as the segment stays clear after each step; from
there z stands still, the body catches up, and the segment only shrinks. This holds for every path and any lag,
but for what the barrier's samples leave open anyway: a straight step of length s between two points at R passes
h = -s^2 / 4. That much is let pass; else a robot that stands on a margin could not go along it.
"""

import math

import numpy as np

from farhand.common.geometry import Array
from farhand.operator_side.control import barrier as rows
from farhand.operator_side.control.controller import ControlProblem

NEAR = 1e-5  # m


def clear_steps(
    problem: ControlProblem, radii: Array, plan: Array, motion: tuple[Array, float, float]
) -> int:
    """How many steps of the plan leave a clear segment between body and z, or one no nearer than standing still does.

    Args:
        problem: the tick's problem; its position is z.
        radii: (n,) that the body must keep (m).
        plan: (N, 3), m/s.
        motion: (3,) velocity of the body at the plan's beginning (m/s), its lag, length of a step (s).
    """
    velocity, lag, dt = motion
    kept, n = math.exp(-dt / lag), len(plan)
    velocities = np.empty((n + 1, 3))  # of the body, at the beginning of each step and at the end
    velocities[0] = velocity
    for i in range(n):
        velocities[i + 1] = kept * velocities[i] + (1.0 - kept) * plan[i]
    along = rows.path(problem, plan, dt)
    after = np.arange(1, n + 1)[:, None] * dt
    centres = problem.centres[:, None] + after * problem.velocities[:, None]
    gaps = _gaps(along[1:] - centres, lag * (velocities[1:] - problem.velocities[:, None]))
    standing = _gaps(along[:-1] - centres, lag * (kept * velocities[:-1] - problem.velocities[:, None]))
    speeds = np.sqrt(np.einsum("ik,ik->i", plan, plan))
    step = dt * (np.maximum(speeds, np.linalg.norm(velocities[:-1], axis=1)) + _speeds(problem)[:, None])
    kept_clear = np.sqrt(np.maximum(radii[:, None] ** 2 - 0.25 * step**2, 0.0))
    fine = np.all(gaps >= np.minimum(kept_clear, standing) - NEAR, axis=0)
    return n if fine.all() else int(np.argmin(fine))


def _speeds(problem: ControlProblem) -> Array:
    speeds: Array = np.sqrt(np.einsum("jk,jk->j", problem.velocities, problem.velocities))
    return speeds


def _gaps(z: Array, trail: Array) -> Array:
    """(n, N) distances of obstacles to segments: `z` (n, N, 3) from the obstacle, the body `trail` behind it (m)."""
    square = np.einsum("jik,jik->ji", trail, trail)
    share = np.einsum("jik,jik->ji", z, trail) / np.maximum(square, 1e-12)
    nearest = z - np.clip(share, 0.0, 1.0)[:, :, None] * trail
    gaps: Array = np.sqrt(np.einsum("jik,jik->ji", nearest, nearest))
    return gaps
