"""The quadratic part of the cost, as matrices over the stages; the three axes are alike and uncoupled."""

import numpy as np

from farhand.common.geometry import Array
from farhand.operator_side.control.settings import ControllerSettings


def tracking_matrices(settings: ControllerSettings) -> tuple[Array, Array]:
    """W (N+1, N+1) and w (N+1,): on each axis the tracking cost is u'W u - 2 (w'u) desired + const."""
    n = settings.horizon
    matrix = np.zeros((n + 1, n + 1))
    for i in range(n):
        matrix[i, i] += settings.q + settings.r + settings.s
        matrix[i + 1, i + 1] += settings.s
        matrix[i, i + 1] -= settings.s
        matrix[i + 1, i] -= settings.s
    matrix[n, n] += settings.p
    linear = np.full(n + 1, settings.q)
    linear[n] = settings.p
    return matrix, linear


def unconstrained_gains(settings: ControllerSettings) -> Array:
    """(N+1,) factors c_i: without obstacles and box the optimum is u_i = c_i times the desired velocity."""
    return np.asarray(np.linalg.solve(*tracking_matrices(settings)), dtype=np.float64)


def tracking_cost(plan: Array, desired: Array, settings: ControllerSettings) -> float:
    """The quadratic part of the cost of (N+1, 3) velocities (m/s)."""
    error = plan - desired
    cost = settings.q * np.sum(error[:-1] ** 2) + settings.r * np.sum(plan[:-1] ** 2)
    cost += settings.s * np.sum(np.diff(plan, axis=0) ** 2) + settings.p * np.sum(error[-1] ** 2)
    return float(cost)
