"""The barrier rows in numpy: what the solvers without compiled code, the baselines and the checks share.

A row (j, i) is h_j(x_{i+1}) - sigma_j >= omega (1 - gamma) h_j(x_i), h_j(x_i) = |x_i - p_j - i dt v_j|^2 -
R_j^2, omega >= 0. Rows of the paper (arXiv 2403.18650), with a velocity and a margin for each obstacle.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from farhand.common.geometry import Array
from farhand.operator_side.control.controller import ControlProblem
from farhand.operator_side.control.settings import ControllerSettings

ROW_TOLERANCE = 1e-5  # m^2; the compiled solver's as well
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
    return not n or bool(problem.radii.min() >= 0.0)


def path(problem: ControlProblem, plan: Array, dt: float) -> Array:
    """(M+1, 3) positions x_0..x_M along the (M, 3) plan (m)."""
    return np.vstack([problem.position, problem.position + dt * np.cumsum(plan, axis=0)])


def barriers(problem: ControlProblem, positions: Array, dt: float) -> Array:
    """(n, M+1) values h_j(x_i) at (M+1, 3) positions (m^2)."""
    moved = np.arange(len(positions))[:, None] * dt * problem.velocities[:, None, :]
    away = positions[None, :, :] - problem.centres[:, None, :] - moved
    values: Array = np.einsum("jik,jik->ji", away, away) - problem.radii[:, None] ** 2
    return values


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
    distance = np.linalg.norm(problem.position - problem.centres, axis=1)
    answer: NDArray[np.bool_] = (discriminant >= 0.0) & (distance - (settings.horizon - 1) * step < bound)
    return answer


def cannot_recover(problem: ControlProblem, settings: ControllerSettings) -> bool:
    """Whether one step provably cannot reach h >= sigma somewhere though its row demands it."""
    dt = settings.period
    away = problem.position - problem.centres
    now = np.sum(away**2, axis=1) - problem.radii**2
    farthest = np.sum(
        (np.abs(away - dt * problem.velocities) + dt * np.array(settings.speed_limit)) ** 2, axis=1
    )
    lost = farthest - problem.radii**2 < problem.sigmas - ROW_TOLERANCE
    return bool(np.any(((1.0 - settings.gamma) * now >= 0.0) & lost))


def subset(problem: ControlProblem, keep: NDArray[np.bool_] | NDArray[np.intp]) -> ControlProblem:
    """The problem with some of its obstacles."""
    return replace(
        problem,
        centres=problem.centres[keep],
        radii=problem.radii[keep],
        velocities=problem.velocities[keep],
        sigmas=problem.sigmas[keep],
    )


def leaving_velocity(problem: ControlProblem, settings: ControllerSettings) -> Array:
    """(3,) straight away from the nearest obstacle at 0.6 of the limits (m/s); upwards from its very
    centre."""
    away = problem.position - problem.centres
    distance = np.linalg.norm(away, axis=1)
    nearest = int(np.argmin(distance - problem.radii))
    if distance[nearest] < 1e-9:
        return np.array([0.0, 0.0, 0.6 * settings.speed_limit[2]])
    velocity: Array = 0.6 * np.array(settings.speed_limit) * away[nearest] / distance[nearest]
    return velocity
