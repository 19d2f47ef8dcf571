"""The paper's problem, stated once in CasADi: for the oracle, for the SQP, and for reference derivatives.

Periotto et al., "MPC-CBF with Adaptive Safety Margins", arXiv 2403.18650. With x_{i+1} = x_i + dt u_i:
    least  |u_N - u^|^2_P + sum_{i<N} (|u_i - u^|^2_Q + |u_i|^2_R + |u_{i+1} - u_i|^2_S
                                       + sum_j P_omega (omega_ij - 1)^2)
    with   |u_i| <= u_b on each axis, omega_ij >= 0, and for each obstacle j and stage i < N
           h_j(x_{i+1}) - sigma_j >= omega_ij (1 - gamma) h_j(x_i),
           h_j(x_i) = |x_i - p_j - i dt v_j|^2 - R_j^2, of a plane n_j . (x_i - p_j - i dt v_j) - R_j.
SI units; base frame.
"""

from dataclasses import dataclass
from typing import Any

import casadi
import numpy as np

from farhand.common.geometry import Array
from farhand.operator_side.control.controller import ControlProblem
from farhand.operator_side.control.settings import ControllerSettings


@dataclass(frozen=True)
class SymbolicProblem:
    """A nonlinear program in CasADi's terms.

    Attributes:
        variables: u (3(N+1), stage by stage), then x_1..x_N (3N) unless condensed, then omega (N times
        slots). parameters: x_0 (3), u^ (3), then for each slot centre (3), R, velocity (3), sigma,
        normal (3; zero for spheres).
        cost, constraints: expressions in them; dynamics first unless condensed, then the rows slot by slot.
        lower, upper: bounds of the variables.
        constraints_lower, constraints_upper: bounds of the constraints.
        velocities: how many of the variables are velocities.
        slots: number of obstacles.
    """

    variables: Any
    parameters: Any
    cost: Any
    constraints: Any
    lower: Array
    upper: Array
    constraints_lower: Array
    constraints_upper: Array
    velocities: int
    slots: int

    @property
    def nlp(self) -> dict[str, Any]:
        """As casadi.nlpsol wants it."""
        return {"x": self.variables, "p": self.parameters, "f": self.cost, "g": self.constraints}


def state_problem(settings: ControllerSettings, slots: int, condensed: bool) -> SymbolicProblem:
    """The problem with a given number of obstacles.

    Args:
        settings: horizon, period, weights, decay rate and limits.
        slots: number of obstacles.
        condensed: whether the positions are replaced by sums of velocities, which leaves u and omega.
    """
    n, dt = settings.horizon, settings.period
    u = casadi.SX.sym("u", 3, n + 1)
    omega = casadi.SX.sym("omega", n, slots)
    start = casadi.SX.sym("start", 3)
    desired = casadi.SX.sym("desired", 3)
    obstacles = casadi.SX.sym("obstacles", 11, slots)
    free = casadi.SX.sym("x", 3, 0 if condensed else n)

    path = [start]
    gaps = []
    for i in range(n):
        reached = path[i] + dt * u[:, i]
        path.append(reached if condensed else free[:, i])
        if not condensed:
            gaps.append(free[:, i] - reached)
    rows = [
        barrier(path[i + 1], i + 1, obstacles[:, j], dt)
        - obstacles[7, j]
        - omega[i, j] * (1.0 - settings.gamma) * barrier(path[i], i, obstacles[:, j], dt)
        for j in range(slots)
        for i in range(n)
    ]
    cost = tracking_cost(u, desired, settings) + settings.p_omega * casadi.sumsqr(omega - 1.0)
    limit = np.tile(settings.speed_limit, n + 1)
    unbounded = np.full(free.numel(), np.inf)
    nothing = np.zeros(3 * len(gaps))
    return SymbolicProblem(
        variables=casadi.vertcat(casadi.vec(u), casadi.vec(free), casadi.vec(omega)),
        parameters=casadi.vertcat(start, desired, casadi.vec(obstacles)),
        cost=cost,
        constraints=casadi.vertcat(*gaps, *rows),
        lower=np.concatenate([-limit, -unbounded, np.zeros(n * slots)]),
        upper=np.concatenate([limit, unbounded, np.full(n * slots, np.inf)]),
        constraints_lower=np.concatenate([nothing, np.zeros(len(rows))]),
        constraints_upper=np.concatenate([nothing, np.full(len(rows), np.inf)]),
        velocities=u.numel(),
        slots=slots,
    )


def barrier(position: Any, stage: int, obstacle: Any, dt: float) -> Any:
    """h of one obstacle (11,) at a position (3,) of the given stage."""
    away = position - obstacle[:3] - stage * dt * obstacle[4:7]
    normal, radius = obstacle[8:11], obstacle[3]
    flat = casadi.sumsqr(normal)
    return (1 - flat) * (casadi.sumsqr(away) - radius**2) + casadi.dot(normal, away) - flat * radius


def tracking_cost(u: Any, desired: Any, settings: ControllerSettings) -> Any:
    """The quadratic part of the cost for (3, N+1) velocities."""
    n = settings.horizon
    cost = settings.p * casadi.sumsqr(u[:, n] - desired)
    for i in range(n):
        cost += settings.q * casadi.sumsqr(u[:, i] - desired) + settings.r * casadi.sumsqr(u[:, i])
        cost += settings.s * casadi.sumsqr(u[:, i + 1] - u[:, i])
    return cost


def parameter_values(problem: ControlProblem, slots: int) -> Array:
    """Values for `parameters`; slots without an obstacle get one that is 10 m away and never binds."""
    count = len(problem.radii)
    table = np.zeros((slots, 11))
    table[:, :3] = problem.position + np.array([10.0, 0.0, 0.0])
    table[:count, :3] = problem.centres
    table[:count, 3] = problem.radii
    table[:count, 4:7] = problem.velocities
    table[:count, 7] = problem.sigmas
    if problem.normals is not None:
        table[:count, 8:] = problem.normals
    return np.concatenate([problem.position, problem.desired, table.ravel()])
