"""MPC-CBF by CasADi's SQP: condensed, Gauss-Newton, OSQP on a fixed number of obstacle slots."""

from collections.abc import Callable
from typing import Any

import casadi
import numpy as np

from farhand.operator_side.control import barrier as rows
from farhand.operator_side.control.controller import ControlProblem, ControlSolution, Status
from farhand.operator_side.control.nlp_controller import Indices, NlpController
from farhand.operator_side.control.settings import ControllerSettings
from farhand.operator_side.control.statement import SymbolicProblem, state_problem
from farhand.operator_side.control.tracking import tracking_cost, unconstrained_gains

SLOTS = (1, 2, 4, 8, 16, 24)
ITERATIONS = 12  # past this a start has never been seen to converge in time for the next tick


class SqpController(NlpController):
    """Prunes exactly, fills the smallest set of slots that suffices, keeps the plan as the next warm start.

    Where more obstacles can bind than there are slots, the nearest are taken; the answer is still judged
    against all.
    """

    def __init__(self, settings: ControllerSettings) -> None:
        super().__init__(settings, warm=True)
        self._gains = unconstrained_gains(settings)
        self._programs: dict[int, tuple[SymbolicProblem, Callable[..., Any]]] = {}

    def prepare(self) -> None:
        """Build the programs of all sizes."""
        for slots in SLOTS:
            self._program(slots)

    def _shortcut(self, problem: ControlProblem) -> ControlSolution | None:
        """The optimum without obstacles, where it is also the optimum with them."""
        plan = np.outer(self._gains, problem.desired)
        if np.any(np.abs(plan) > self._limit) or not rows.all_hold(problem, plan[:-1], self.settings):
            return None
        self.reset()
        cost = tracking_cost(plan, problem.desired, self.settings)
        return ControlSolution(plan[:-1], Status.SHORTCUT, cost)

    def _choose(self, problem: ControlProblem) -> Indices:
        chosen = np.flatnonzero(rows.can_bind(problem, self.settings))
        if len(chosen) > SLOTS[-1]:
            gap = np.linalg.norm(problem.position - problem.centres[chosen], axis=1) - problem.radii[chosen]
            chosen = np.sort(chosen[np.argsort(gap, kind="stable")[: SLOTS[-1]]])
        return chosen

    def _program(self, count: int) -> tuple[SymbolicProblem, Callable[..., Any]]:
        slots = next(size for size in SLOTS if size >= count)
        if slots not in self._programs:
            symbolic = state_problem(self.settings, slots, condensed=True)
            self._programs[slots] = symbolic, _gauss_newton_sqp(symbolic, self.settings)
        return self._programs[slots]


def _gauss_newton_sqp(symbolic: SymbolicProblem, settings: ControllerSettings) -> Callable[..., Any]:
    hessian = casadi.hessian(symbolic.cost, symbolic.variables)[0]
    factor = casadi.SX.sym("factor")
    multipliers = casadi.SX.sym("multipliers", symbolic.constraints.numel())
    solver: Callable[..., Any] = casadi.nlpsol(
        "sqp",
        "sqpmethod",
        symbolic.nlp,
        {
            # the rows' own curvature is left out, so that every QP is convex
            "hess_lag": casadi.Function(
                "hessian", [symbolic.variables, symbolic.parameters, factor, multipliers], [factor * hessian]
            ),
            "qpsol": "osqp",
            "qpsol_options": {
                "osqp": {"verbose": False, "eps_abs": 1e-4, "eps_rel": 1e-4, "max_iter": 1000},
                "error_on_fail": False,
            },
            "max_iter": min(settings.max_iterations, ITERATIONS),
            "tol_pr": 1e-6,
            "tol_du": 1e-2,  # of a gradient: with the paper's weights 1e-2 is 0.2 mm/s
            "min_step_size": 1e-10,
            "print_header": False,
            "print_iteration": False,
            "print_status": False,
            "print_time": False,
            "error_on_fail": False,
        },
    )
    return solver
