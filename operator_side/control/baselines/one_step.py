"""Baseline: the one-step barrier filter: the velocity nearest to the desired one that keeps the decay."""

import daqp
import numpy as np

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

REFINEMENTS = 3


class OneStep(Controller):
    """min |u - desired|^2 over the box, subject to h_j(x + dt u) - sigma_j >= (1 - gamma) h_j(x).

    The row is convex in u, so its tangent at any u_0 is on the safe side: a first QP with the tangent at the
    velocity of the obstacle, then a few with the tangents at the last answer, each at least as good as the
    one before. It plans one step; the rest of the plan stands still.
    """

    def __init__(self, settings: ControllerSettings) -> None:
        super().__init__(settings)
        self._limit = np.array(settings.speed_limit)

    def solve(self, problem: ControlProblem) -> ControlSolution:
        """OPTIMAL; INFEASIBLE where provably no velocity helps; FAILED where the QP finds none."""
        plan = zero_plan(self.settings)
        if not rows.input_is_good(problem):
            return ControlSolution(plan, Status.BAD_INPUT)
        velocity = self._filter(problem, problem.velocities)
        if velocity is None:
            proven = rows.cannot_recover(problem, self.settings)
            return ControlSolution(plan, Status.INFEASIBLE if proven else Status.FAILED)
        count = 1
        for _ in range(REFINEMENTS):
            better = self._filter(problem, np.tile(velocity, (len(problem.radii), 1)))
            if better is None or np.abs(better - velocity).max() < 1e-6:
                break
            velocity = better
            count += 1
        plan[0] = velocity
        violation, binding = rows.worst_violation(problem, plan[:1], self.settings)
        cost = float(np.sum((velocity - problem.desired) ** 2))
        if violation > rows.ROW_TOLERANCE:
            return ControlSolution(plan, Status.ELASTIC, cost, violation, count, binding)
        return ControlSolution(plan, Status.OPTIMAL, cost, violation, count, binding)

    def _filter(self, problem: ControlProblem, around: Array) -> Array | None:
        """The QP with row j's tangent at the velocity around[j] (m/s); None where it has no answer."""
        dt = self.settings.period
        away = problem.position - problem.centres  # of the obstacle now
        reached = away + dt * (around - problem.velocities)
        now = rows.values(problem, away[:, None])[:, 0]
        value = rows.values(problem, reached[:, None])[:, 0] - problem.sigmas
        slope = 2.0 * dt * reached
        if problem.normals is not None:
            slope = np.where(problem.flat[:, None] != 0.0, dt * problem.normals, slope)
        bound = (1.0 - self.settings.gamma) * now - value + np.sum(slope * around, axis=1)
        upper = np.concatenate([self._limit, np.full(len(bound), 1e30)])
        lower = np.concatenate([-self._limit, bound])
        sense = np.zeros(len(upper), dtype=np.int32)
        velocity, _, flag, _ = daqp.solve(
            np.eye(3),
            -np.asarray(problem.desired, dtype=float),
            np.ascontiguousarray(slope),
            upper,
            lower,
            sense,
        )
        if flag != 1 or not np.all(np.isfinite(velocity)):
            return None
        answer: Array = np.clip(velocity, -self._limit, self._limit)
        return answer
