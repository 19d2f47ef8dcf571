"""The barrier rows in numpy: what the solvers without compiled code, the baselines and the checks share.

A row (j, i) is h_j(x_{i+1}) - sigma_j >= omega (1 - gamma) h_j(x_i), h_j(x_i) = |x_i - p_j - i dt v_j|^2 -
R_j^2, omega >= 0. Rows of the paper (arXiv 2403.18650), with a velocity and a margin for each obstacle; planes have
h_j(x_i) = n_j . (x_i - p_j - i dt v_j) - R_j, in m.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from farhand.common.geometry import Array
from farhand.operator_side.control.controller import ControlProblem
from farhand.operator_side.control.settings import ControllerSettings

ROW_TOLERANCE = 1e-5  # m^2; the compiled solver's as well
FEW = 16
PLAIN = 1e-9  # m^2, by which sums that are added up in another order never differ
MAGNITUDE = 1e6  # inputs beyond this are refused, as by the compiled solver


def input_is_good(problem: ControlProblem) -> bool:
    """Whether shapes fit, every number is finite and sensible, and no radius is negative."""
    n = len(problem.radii) if isinstance(problem.radii, np.ndarray) and problem.radii.ndim == 1 else -1
    shapes = (
        (problem.position, (3,)),
        (problem.desired, (3,)),
        (problem.centres, (n, 3)),
        (problem.radii, (n,)),
        (problem.velocities, (n, 3)),
        (problem.sigmas, (n,)),
    )
    for array, shape in shapes:
        if not isinstance(array, np.ndarray) or array.shape != shape or array.dtype.kind not in "fiu":
            return False
        if array.size and not np.abs(array).max() < MAGNITUDE:
            return False
    return not n or (bool(problem.radii.min() >= 0.0) and _normals_are_good(problem))


def _normals_are_good(problem: ControlProblem) -> bool:
    normals = problem.normals
    if normals is None:
        return True
    if normals.shape != problem.centres.shape or normals.dtype.kind not in "fiu":
        return False
    return bool(np.all(np.abs(np.sum(normals**2, axis=1) - problem.flat) < 1e-6))


def path(problem: ControlProblem, plan: Array, dt: float) -> Array:
    """(M+1, 3) positions x_0..x_M along the (M, 3) plan (m)."""
    return np.vstack([problem.position, problem.position + dt * np.cumsum(plan, axis=0)])


def barriers(problem: ControlProblem, positions: Array, dt: float) -> Array:
    """(n, M+1) values h_j(x_i) at (M+1, 3) positions (m^2)."""
    moved = np.arange(len(positions))[:, None] * dt * problem.velocities[:, None, :]
    return values(problem, positions[None, :, :] - problem.centres[:, None, :] - moved)


def values(problem: ControlProblem, away: Array) -> Array:
    """(n, M) values of h at (n, M, 3) offsets from the obstacles' centres (m^2; planes m)."""
    squares: Array = np.einsum("jik,jik->ji", away, away) - problem.radii[:, None] ** 2
    if problem.normals is None:
        return squares
    heights = np.einsum("jk,jik->ji", problem.normals, away) - problem.radii[:, None]
    return np.where(problem.flat[:, None] != 0.0, heights, squares)


def starts_clear(problem: ControlProblem) -> bool:
    """Whether the start is plainly outside every margin of few spheres; False says nothing.

    Asked twice a tick, when the answer is nearly always yes: a plain loop over few obstacles takes a fifth of numpy's.
    """
    if problem.normals is not None or len(problem.radii) > FEW:
        return False
    x, y, z = problem.position.tolist()
    spheres = zip(problem.centres.tolist(), problem.radii.tolist(), problem.sigmas.tolist(), strict=True)
    for (a, b, c), radius, sigma in spheres:
        least = radius * radius + sigma
        if not (a - x) ** 2 + (b - y) ** 2 + (c - z) ** 2 > least + PLAIN:
            return False
    return True


def gaps(problem: ControlProblem) -> tuple[Array, Array]:
    """Distance of the start from each obstacle's centre, of a plane from it (n,), and outward normals (n, 3).

    Where the start is at a centre, the normal is zero.
    """
    away = problem.position - problem.centres
    lengths = np.sqrt(np.einsum("jk,jk->j", away, away))
    outward = away / np.where(lengths > 0.0, lengths, 1.0)[:, None]
    if problem.normals is None:
        return lengths, outward
    flat = problem.flat != 0.0
    heights = np.einsum("jk,jk->j", problem.normals, away)
    return np.where(flat, heights, lengths), np.where(flat[:, None], problem.normals, outward)


def reaches(problem: ControlProblem) -> Array:
    """(n,) distance from each obstacle's centre, or from the plane, at which h = sigma (m)."""
    spheres: Array = np.sqrt(problem.radii**2 + problem.sigmas)
    if problem.normals is None:
        return spheres
    return np.where(problem.flat != 0.0, problem.radii + problem.sigmas, spheres)


def all_hold(problem: ControlProblem, plan: Array, settings: ControllerSettings) -> bool:
    """Whether every row holds with omega = 1."""
    h = barriers(problem, path(problem, plan, settings.period), settings.period)
    return bool(np.all(h[:, 1:] - problem.sigmas[:, None] >= (1.0 - settings.gamma) * h[:, :-1]))


def worst_violation(problem: ControlProblem, plan: Array, settings: ControllerSettings) -> tuple[float, int]:
    """Largest violation of a row with its best omega (m^2), and the obstacle with the least room, -1 if none.

    Only rows with (1 - gamma) h(x_i) >= 0 can be violated: elsewhere a larger omega pays for anything.
    """
    if not len(problem.radii):
        return 0.0, -1
    h = barriers(problem, path(problem, plan, settings.period), settings.period)
    room = h[:, 1:] - problem.sigmas[:, None]
    hard = np.where((1.0 - settings.gamma) * h[:, :-1] > -1e-9, room, np.inf)
    return max(0.0, -float(hard.min())), int(np.argmin(room.min(axis=1)))


def relaxation_cost(problem: ControlProblem, plan: Array, settings: ControllerSettings) -> float:
    """Sum over the rows of P_omega (omega - 1)^2 with the best omega for each."""
    h = barriers(problem, path(problem, plan, settings.period), settings.period)
    t = h[:, 1:] - problem.sigmas[:, None]
    b = (1.0 - settings.gamma) * h[:, :-1]
    ratio = t / np.where(np.abs(b) > 1e-9, b, 1.0)
    outside = np.where(b > 1e-9, np.clip(ratio, 0.0, 1.0), 1.0)
    omega = np.where((b < -1e-9) & (t < b), ratio, outside)
    return float(settings.p_omega * np.sum((omega - 1.0) ** 2))


def can_bind(problem: ControlProblem, settings: ControllerSettings) -> NDArray[np.bool_]:
    """(n,) which obstacles can bind within the horizon; exact, see docs/solver.md, "Pruning"."""
    dt, gamma = settings.period, settings.gamma
    step = dt * (np.linalg.norm(settings.speed_limit) + np.linalg.norm(problem.velocities, axis=1))
    rest = step**2 - gamma * problem.radii**2 - problem.sigmas
    discriminant = step**2 - gamma * rest
    bound = (step + np.sqrt(np.maximum(discriminant, 0.0))) / gamma
    distance, _ = gaps(problem)
    farthest_in = distance - (settings.horizon - 1) * step
    answer: NDArray[np.bool_] = (discriminant >= 0.0) & (farthest_in < bound)
    if problem.normals is None:
        return answer
    binds = gamma * (farthest_in - problem.radii) < step + problem.sigmas
    return np.where(problem.flat != 0.0, binds, answer)


def cannot_recover(problem: ControlProblem, settings: ControllerSettings) -> bool:
    """Whether one step provably cannot reach h >= sigma somewhere though its row demands it."""
    dt = settings.period
    away = problem.position - problem.centres
    now = values(problem, away[:, None, :])[:, 0]
    limits = np.array(settings.speed_limit)
    drifted = away - dt * problem.velocities
    farthest = np.sum((np.abs(drifted) + dt * limits) ** 2, axis=1) - problem.radii**2
    if problem.normals is not None:
        heights = np.sum(problem.normals * drifted + np.abs(problem.normals) * dt * limits, axis=1)
        farthest = np.where(problem.flat != 0.0, heights - problem.radii, farthest)
    lost = farthest < problem.sigmas - ROW_TOLERANCE
    return bool(np.any(((1.0 - settings.gamma) * now >= 0.0) & lost))


def subset(problem: ControlProblem, keep: NDArray[np.bool_] | NDArray[np.intp]) -> ControlProblem:
    """The problem with some of its obstacles."""
    return replace(
        problem,
        centres=problem.centres[keep],
        radii=problem.radii[keep],
        velocities=problem.velocities[keep],
        sigmas=problem.sigmas[keep],
        normals=None if problem.normals is None else problem.normals[keep],
    )


def leaving_velocity(problem: ControlProblem, settings: ControllerSettings) -> Array:
    """(3,) straight away from the nearest obstacle at 0.6 of the limits (m/s); upwards from its very
    centre."""
    distance, outward = gaps(problem)
    nearest = int(np.argmin(distance - problem.radii))
    if not np.any(outward[nearest]):
        return np.array([0.0, 0.0, 0.6 * settings.speed_limit[2]])
    velocity: Array = 0.6 * np.array(settings.speed_limit) * outward[nearest]
    return velocity
