"""Which velocities the barrier would let pass nearly as they are: one step, without a solver.

Row (j, 0) of barrier.py says that the step must end outside a sphere: |x + dt u - p_j - dt v_j| >= rho_j, rho_j^2 =
R_j^2 + sigma_j + (1 - gamma) h_j(x). In u that is the outside of a ball, and of a plane one side of a plane, so that
the least change which one row asks for has a closed form; of several, the deepest is left first, a few times over.
"""

from dataclasses import dataclass

import numpy as np

from farhand.common.geometry import Array
from farhand.operator_side.control.controller import ControlProblem
from farhand.operator_side.control.settings import ControllerSettings

SWEEPS = 8
CLEAN = 1e-6
"""A row that is missed by less (m/s) is kept."""
_LOST = 1e-3
"""A row that is missed by more after all sweeps (m/s): no velocity was found."""


def changes(problem: ControlProblem, velocities: Array, settings: ControllerSettings) -> Array:
    """(k,) by how much the velocities (k, 3) would have to change to keep every row and limit (m/s).

    Infinite where no change was found. Nothing throws.

    Args:
        problem: where the robot is, and what it has to keep clear of; what is desired does not matter.
        velocities: (m/s).
        settings: of the filter.
    """
    limit = np.array(settings.speed_limit)
    found: Array = np.clip(velocities, -limit, limit)
    lost = np.zeros(len(found), dtype=bool)
    if len(problem.radii):
        rows = _Rows.of(problem, settings)
        everyone = np.arange(len(found))
        for _ in range(SWEEPS):
            outward, lacks = rows.look(found)
            deepest = np.argmax(lacks, axis=1)
            depth = np.maximum(lacks[everyone, deepest], 0.0)
            if depth.max(initial=0.0) < CLEAN:
                break
            found = np.clip(found + depth[:, None] * outward[everyone, deepest], -limit, limit)
        lost = np.max(rows.look(found)[1], axis=1) > _LOST
    change: Array = np.linalg.norm(found - velocities, axis=1)
    change[lost] = np.inf
    return change


def in_the_way(problem: ControlProblem, velocity: Array, settings: ControllerSettings) -> int:
    """The row that asks a velocity (3,) for the largest change; -1: none does."""
    if not len(problem.radii):
        return -1
    _, lacks = _Rows.of(problem, settings).look(velocity[None, :])
    deepest = int(np.argmax(lacks[0]))
    return deepest if lacks[0, deepest] > CLEAN else -1


@dataclass(frozen=True, slots=True)
class _Rows:
    """Attributes:
    centres: (n, 3) of the balls that velocities must be outside of (m/s).
    radii: (n,) of these; of a plane, how fast it must be left along its normal (m/s).
    normals: (n, 3) of planes, zero for spheres; None: all are spheres.
    flat: (n,) which are planes.
    """

    centres: Array
    radii: Array
    normals: Array | None
    flat: Array

    @classmethod
    def of(cls, problem: ControlProblem, settings: ControllerSettings) -> "_Rows":
        """The rows of one step."""
        dt, kept = settings.period, 1.0 - settings.gamma
        to_obstacle = problem.centres - problem.position
        now = np.einsum("jk,jk->j", to_obstacle, to_obstacle) - problem.radii**2
        radii = np.sqrt(np.maximum(problem.radii**2 + problem.sigmas + kept * now, 0.0)) / dt
        flat = problem.flat != 0.0
        if problem.normals is not None:
            height = -np.einsum("jk,jk->j", problem.normals, to_obstacle) - problem.radii
            leaving = np.einsum("jk,jk->j", problem.normals, problem.velocities)
            radii = np.where(flat, (problem.sigmas - settings.gamma * height) / dt + leaving, radii)
        return cls(to_obstacle / dt + problem.velocities, radii, problem.normals, flat)

    def look(self, velocities: Array) -> tuple[Array, Array]:
        """(k, n, 3) ways out of each row, unit vectors, and (k, n) how much is lacking (m/s)."""
        away = velocities[:, None, :] - self.centres
        lengths = np.sqrt(np.einsum("ijk,ijk->ij", away, away))
        outward: Array = away / np.maximum(lengths, 1e-12)[:, :, None]
        if self.normals is None:
            return outward, self.radii - lengths
        along = np.einsum("jk,ik->ij", self.normals, velocities)
        outward = np.where(self.flat[None, :, None], self.normals[None, :, :], outward)
        return outward, self.radii - np.where(self.flat, along, lengths)
