"""Which velocities the barrier would let pass nearly as they are: one step, without a solver.

Row (j, 0) of barrier.py says that the step must end outside a sphere: |x + dt u - p_j - dt v_j| >= rho_j, rho_j^2 =
R_j^2 + sigma_j + (1 - gamma) h_j(x). In u that is the outside of a ball, so that the least change which one
row asks for has a closed form; of several, the deepest is left first, a few times over.
"""

import numpy as np

from farhand.common.geometry import Array
from farhand.operator_side.control.controller import ControlProblem
from farhand.operator_side.control.settings import ControllerSettings

SWEEPS = 8
CLEAN = 1e-6
"""A row that is missed by less (m/s) is kept."""


def changes(
    problem: ControlProblem, velocities: Array, settings: ControllerSettings, steps: int = 1
) -> Array:
    """(k,) by how much the velocities (k, 3) would have to change to keep every row and limit (m/s).

    Infinite where no change was found. Nothing throws.

    Args:
        problem: where the robot is, and what it has to keep clear of; what is desired does not matter.
        velocities: held for `steps` periods (m/s).
        settings: of the filter.
        steps: over how many periods one looks ahead.
    """
    limit = np.array(settings.speed_limit)
    found: Array = np.clip(velocities, -limit, limit)
    if len(problem.radii):
        centres, radii = _balls(problem, settings, steps)
        for _ in range(SWEEPS):
            found, deepest = _out_of_the_deepest(found, centres, radii)
            found = np.clip(found, -limit, limit)
            if deepest < CLEAN:
                break
        _, lacks = _lacking(found, centres, radii)
        lost = np.max(lacks, axis=1) > 1e3 * CLEAN
    else:
        lost = np.zeros(len(found), dtype=bool)
    change: Array = np.linalg.norm(found - velocities, axis=1)
    change[lost] = np.inf
    return change


def in_the_way(problem: ControlProblem, velocity: Array, settings: ControllerSettings, steps: int = 1) -> int:
    """Index of the obstacle whose row asks a velocity (3,) for the largest change; -1: none does."""
    if not len(problem.radii):
        return -1
    _, lacks = _lacking(velocity[None, :], *_balls(problem, settings, steps))
    deepest = int(np.argmax(lacks[0]))
    return deepest if lacks[0, deepest] > CLEAN else -1


def _balls(problem: ControlProblem, settings: ControllerSettings, steps: int) -> tuple[Array, Array]:
    """Centres (n, 3) and radii (n,) of the balls that velocities must be outside of (m/s)."""
    duration = steps * settings.period
    to_obstacle = problem.centres - problem.position
    now = np.einsum("jk,jk->j", to_obstacle, to_obstacle) - problem.radii**2
    kept = problem.radii**2 + problem.sigmas + (1.0 - settings.gamma) ** steps * now
    return to_obstacle / duration + problem.velocities, np.sqrt(np.maximum(kept, 0.0)) / duration


def _lacking(velocities: Array, centres: Array, radii: Array) -> tuple[Array, Array]:
    """(k, n, 3) velocities away from the balls' centres, and (k, n) how far they are inside (m/s)."""
    away = velocities[:, None, :] - centres
    lacks: Array = radii - np.sqrt(np.einsum("ijk,ijk->ij", away, away))
    return away, lacks


def _out_of_the_deepest(velocities: Array, centres: Array, radii: Array) -> tuple[Array, float]:
    """Each velocity moved to the surface of the ball that it is deepest in; the largest depth before."""
    away, lacks = _lacking(velocities, centres, radii)
    rows = np.arange(len(velocities))
    deepest = np.argmax(lacks, axis=1)
    depth = np.maximum(lacks[rows, deepest], 0.0)
    out = away[rows, deepest]
    length = np.linalg.norm(out, axis=1)
    unit = out / np.maximum(length, 1e-12)[:, None]
    return velocities + depth[:, None] * unit, float(depth.max(initial=0.0))
