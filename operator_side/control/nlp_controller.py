"""What the controllers on CasADi's solvers share: input, warm start, and the verdict from true residuals."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from farhand.common.geometry import Array
from farhand.operator_side.control import barrier as rows
from farhand.operator_side.control.controller import (
    Controller,
    ControlProblem,
    ControlSolution,
    Status,
    zero_plan,
)
from farhand.operator_side.control.settings import ControllerSettings
from farhand.operator_side.control.statement import SymbolicProblem, parameter_values
from farhand.operator_side.control.tracking import tracking_cost

Indices = NDArray[np.intp]


class NlpController(Controller):
    """Solves the symbolic problem over some of the obstacles and judges the answer against all of them.

    A subclass says which obstacles (`_choose`) and which program serves that many (`_program`).
    """

    def __init__(self, settings: ControllerSettings, warm: bool) -> None:
        """Keep the settings; `warm` says whether a tick starts from the last tick's answer."""
        super().__init__(settings)
        self._keep_warm = warm
        self._limit = np.array(settings.speed_limit)
        self.reset()

    def reset(self) -> None:
        """Forget the warm start."""
        self._plan: Array | None = None
        self._omega = np.zeros((0, self.settings.horizon))
        self._multipliers = np.zeros((0, self.settings.horizon))

    def solve(self, problem: ControlProblem) -> ControlSolution:
        """Decide one tick, see Controller."""
        if not rows.input_is_good(problem):
            self.reset()
            return ControlSolution(zero_plan(self.settings), Status.BAD_INPUT)
        quick = self._shortcut(problem)
        if quick is not None:
            return quick
        if rows.cannot_recover(problem, self.settings):
            self.reset()
            plan = zero_plan(self.settings)
            plan[0] = rows.leaving_velocity(problem, self.settings)
            violation, binding = rows.worst_violation(problem, plan, self.settings)
            return ControlSolution(plan, Status.INFEASIBLE, violation=violation, binding=binding)
        try:
            return self._solve(problem, self._choose(problem))
        except (RuntimeError, ArithmeticError, ValueError):  # CasADi raises RuntimeError for whatever happens
            self.reset()
            return ControlSolution(zero_plan(self.settings), Status.FAILED)

    def _choose(self, problem: ControlProblem) -> Indices:
        return np.arange(len(problem.radii))

    def _program(self, count: int) -> tuple[SymbolicProblem, Callable[..., Any]]:
        raise NotImplementedError

    def _shortcut(self, problem: ControlProblem) -> ControlSolution | None:
        return None

    def _solve(self, problem: ControlProblem, chosen: Indices) -> ControlSolution:
        symbolic, solver = self._program(len(chosen))
        start, rows_start = self._start(problem, chosen, symbolic)
        answer = solver(
            x0=start,
            lam_g0=rows_start,
            p=parameter_values(rows.subset(problem, chosen), symbolic.slots),
            lbx=symbolic.lower,
            ubx=symbolic.upper,
            lbg=symbolic.constraints_lower,
            ubg=symbolic.constraints_upper,
        )
        values = np.array(answer["x"], dtype=float).ravel()
        full_plan = np.clip(values[: symbolic.velocities].reshape(-1, 3), -self._limit, self._limit)
        if not np.all(np.isfinite(full_plan)):
            self.reset()
            return ControlSolution(zero_plan(self.settings), Status.FAILED)
        stats = solver.stats()  # type: ignore[attr-defined]
        plan = full_plan[:-1]
        violation, binding = rows.worst_violation(problem, plan, self.settings)
        relaxed = rows.relaxation_cost(problem, plan, self.settings)
        cost = tracking_cost(full_plan, problem.desired, self.settings) + relaxed
        if not stats["success"]:
            status = Status.CAPPED
        else:
            status = Status.ELASTIC if violation > rows.ROW_TOLERANCE else Status.OPTIMAL
        if self._keep_warm:
            self._remember(full_plan, values, np.array(answer["lam_g"]).ravel(), problem, chosen, symbolic)
        if status is Status.CAPPED:
            self.reset()
        return ControlSolution(plan.copy(), status, cost, violation, int(stats["iter_count"]), binding)

    def _start(
        self, problem: ControlProblem, chosen: Indices, symbolic: SymbolicProblem
    ) -> tuple[Array, Array]:
        """Where the solver starts: its variables and its constraints' multipliers."""
        n = self.settings.horizon
        omega = np.ones((symbolic.slots, n))
        multipliers = np.zeros((symbolic.slots, n))
        usable = self._plan is not None and len(self._omega) == len(problem.radii)
        if self._plan is not None and usable:
            plan = _shifted(self._plan)
            omega[: len(chosen)] = _shifted(self._omega[chosen].T).T
            multipliers[: len(chosen)] = _shifted(self._multipliers[chosen].T).T
        else:
            plan = np.tile(np.clip(problem.desired, -self._limit, self._limit), (n + 1, 1))
        if len(chosen) and not usable:
            away = problem.position - problem.centres
            if np.any(np.sum(away**2, axis=1) <= problem.radii**2):  # from inside, do not tunnel through
                plan[:] = rows.leaving_velocity(problem, self.settings)
        states = symbolic.variables.numel() - symbolic.velocities - omega.size
        path = rows.path(problem, plan, self.settings.period)[1 : n + 1].ravel() if states else np.zeros(0)
        return (
            np.concatenate([plan.ravel(), path, omega.ravel()]),
            np.concatenate([np.zeros(states), multipliers.ravel()]),
        )

    def _remember(
        self,
        plan: Array,
        values: Array,
        multipliers: Array,
        problem: ControlProblem,
        chosen: Indices,
        symbolic: SymbolicProblem,
    ) -> None:
        n = self.settings.horizon
        size = symbolic.slots * n
        self._plan = plan
        self._omega = np.ones((len(problem.radii), n))
        self._multipliers = np.zeros((len(problem.radii), n))
        self._omega[chosen] = values[len(values) - size :].reshape(-1, n)[: len(chosen)]
        self._multipliers[chosen] = multipliers[len(multipliers) - size :].reshape(-1, n)[: len(chosen)]


def _shifted(stages: Array) -> Array:
    """One step on along the first axis, the last repeated."""
    return np.concatenate([stages[1:], stages[-1:]])
