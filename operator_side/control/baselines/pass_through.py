"""Baseline: the desired velocity, clipped to the box, whatever stands in the way."""

import numpy as np

from farhand.operator_side.control import barrier as rows
from farhand.operator_side.control.controller import (
    Controller,
    ControlProblem,
    ControlSolution,
    Status,
    zero_plan,
)


class PassThrough(Controller):
    """No filter at all; the status still says whether the barrier rows happen to hold."""

    def solve(self, problem: ControlProblem) -> ControlSolution:
        """SHORTCUT where every row holds, else ELASTIC with the violation."""
        if not rows.input_is_good(problem):
            return ControlSolution(zero_plan(self.settings), Status.BAD_INPUT)
        limit = np.array(self.settings.speed_limit)
        plan = np.tile(np.clip(problem.desired, -limit, limit), (self.settings.horizon, 1))
        if rows.all_hold(problem, plan, self.settings):
            return ControlSolution(plan, Status.SHORTCUT)
        violation, binding = rows.worst_violation(problem, plan, self.settings)
        return ControlSolution(plan, Status.ELASTIC, violation=violation, binding=binding)
