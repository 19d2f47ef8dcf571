"""The default controller: MPC-CBF by the compiled Newton solver."""

import numpy as np

from farhand.common.geometry import Array
from farhand.operator_side.control import compile_cache
from farhand.operator_side.control import newton_kernel as kernel
from farhand.operator_side.control.controller import (
    Controller,
    ControlProblem,
    ControlSolution,
    Status,
    zero_plan,
)
from farhand.operator_side.control.settings import ControllerSettings
from farhand.operator_side.control.tracking import tracking_matrices, unconstrained_gains

_STATUS = (
    Status.OPTIMAL,
    Status.SHORTCUT,
    Status.ELASTIC,
    Status.CAPPED,
    Status.INFEASIBLE,
    Status.BAD_INPUT,
)


def kernel_parameters(settings: ControllerSettings) -> Array:
    """The constants that the kernel works with, see its `par`.

    The penalty and the prices of the slack follow the cost's curvature and the period, so that they act
    alike at 10 and at 100 Hz; with the paper's settings they are 5e5, 3e3 and 1e5.
    """
    dt = settings.period
    curvature = 2.0 * max(settings.q + settings.r + 2.0 * settings.s, settings.p + settings.s)
    par = np.empty(kernel.PARAMETERS)
    par[kernel.DT] = dt
    par[kernel.Q], par[kernel.R], par[kernel.P], par[kernel.S] = (
        settings.q,
        settings.r,
        settings.p,
        settings.s,
    )
    par[kernel.P_OMEGA] = settings.p_omega
    par[kernel.DECAY] = 1.0 - settings.gamma
    par[kernel.RHO] = 5e5 * (curvature / 62.0) * (0.1 / dt) ** 2
    par[kernel.PRICE] = 3e3 * (curvature / 62.0) * (0.1 / dt)
    par[kernel.PRICE_MAX] = 1e5 * (curvature / 62.0) * (0.1 / dt)
    par[kernel.CURVATURE] = curvature
    return par


def tracking_hessian(settings: ControllerSettings) -> Array:
    """(3(N+1), BAND) lower band of the tracking cost's Hessian in x_1..x_{N+1}: [r, k] is H[r, r - k]."""
    stages = settings.horizon + 1
    velocity = (np.eye(stages) - np.eye(stages, k=-1)) / settings.period  # u_i = (x_{i+1} - x_i) / dt
    full = np.kron(2.0 * velocity.T @ tracking_matrices(settings)[0] @ velocity, np.eye(3))
    band = np.zeros((3 * stages, kernel.BAND))
    for k in range(kernel.BAND):
        band[k:, k] = np.diagonal(full, -k)
    return band


class NewtonController(Controller):
    """Keeps the plan and the multipliers of the last tick as the warm start of the next."""

    def __init__(self, settings: ControllerSettings) -> None:
        self.settings = settings
        self.solver_notice = compile_cache.NOTICE
        self._par = kernel_parameters(settings)
        self._gains = unconstrained_gains(settings)
        self._limit = np.array(settings.speed_limit, dtype=float)
        self._base = tracking_hessian(settings)
        self._position = np.zeros(3)
        self._desired = np.zeros(3)
        self._plan = np.zeros((settings.horizon + 1, 3))
        self._planes = False  # whether any row of the buffer is one
        self._reserve(16)
        self.reset()

    def prepare(self) -> None:
        """Compile, or load from the cache: the buffers always have the same types, so once is enough."""
        nothing = np.zeros((0, 3))
        none = np.zeros(0)
        self.solve(ControlProblem(np.zeros(3), np.zeros(3), nothing, none, nothing, none))
        self.reset()

    def reset(self) -> None:
        """Forget the warm start."""
        self._warm = False
        self._count = 0

    def solve(self, problem: ControlProblem) -> ControlSolution:
        """Decide one tick, see Controller."""
        try:
            n = self._load(problem)
        except (TypeError, ValueError, AttributeError, IndexError):
            self.reset()
            return ControlSolution(zero_plan(self.settings), Status.BAD_INPUT)
        code, steps, cost, violation, binding = kernel.solve(
            self._position, self._desired, self._obstacles, n, self._plan, self._multipliers,
            self._warm and n == self._count, self._limit, self._par, self._base, self._gains,
            self.settings.max_iterations,
        )  # fmt: skip
        status = _STATUS[code]
        self._count = n
        self._warm = status is not Status.BAD_INPUT
        if not self._warm:
            return ControlSolution(zero_plan(self.settings), status)
        return ControlSolution(self._plan[:-1].copy(), status, cost, violation, steps, binding)

    def _load(self, problem: ControlProblem) -> int:
        """Copy the problem into the kernel's buffers; returns the number of obstacles."""
        n = len(problem.radii)
        if problem.centres.shape != (n, 3) or problem.velocities.shape != (n, 3):
            raise ValueError("centres and velocities must be (n, 3)")
        if problem.sigmas.shape != (n,) or problem.radii.ndim != 1:
            raise ValueError("radii and sigmas must be (n,)")
        if problem.normals is not None and problem.normals.shape != (n, 3):
            raise ValueError("normals must be (n, 3)")
        if problem.position.shape != (3,) or problem.desired.shape != (3,):
            raise ValueError("position and desired must be (3,)")
        if n > len(self._obstacles):
            self._reserve(2 * n)
            self._count = -1
        self._position[:] = problem.position
        self._desired[:] = problem.desired
        if n:
            rows = self._obstacles[:n]
            rows[:, :3] = problem.centres
            rows[:, 3] = problem.radii
            rows[:, 4:7] = problem.velocities
            rows[:, 7] = problem.sigmas
            if problem.normals is not None:
                rows[:, 8:11] = problem.normals
                rows[:, kernel.FLAT] = problem.flat
                self._planes = True
            elif self._planes:
                self._obstacles[:, 8:] = 0.0
                self._planes = False
        return n

    def _reserve(self, capacity: int) -> None:
        self._obstacles = np.zeros((capacity, kernel.COLUMNS))
        self._multipliers = np.zeros((capacity, self.settings.horizon))
