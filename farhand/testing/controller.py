"""A controller that answers what it is given."""

from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from farhand.common.geometry import Array
from farhand.common.messages.base import Vector3
from farhand.operator_side.control.controller import Controller, ControlProblem, ControlSolution, Status
from farhand.operator_side.control.settings import ControllerSettings

Answer: TypeAlias = Vector3 | Array | ControlSolution
"""A velocity held over the horizon (m/s), a plan of shape (N, 3), or a whole solution."""


class ScriptedController(Controller):
    """Keeps every problem and gives the test's answer.

    Args:
        answer: see Answer; or a function that makes one of each problem.
        status: of answers that are no whole solution.
        settings: whose horizon a held velocity has.

    Attributes:
        answer, status: assign to them at any time.
        problems: all that were put to it, in order.
        prepared, resets: how often `prepare` and `reset` were called.
    """

    def __init__(
        self,
        answer: Answer | Callable[[ControlProblem], Answer] = (0.3, 0.0, 0.0),
        status: Status = Status.OPTIMAL,
        settings: ControllerSettings | None = None,
    ) -> None:
        super().__init__(settings or ControllerSettings())
        self.answer = answer
        self.status = status
        self.problems: list[ControlProblem] = []
        self.prepared = 0
        self.resets = 0

    def prepare(self) -> None:
        """Counted in `prepared`."""
        self.prepared += 1

    def reset(self) -> None:
        """Counted in `resets`."""
        self.resets += 1

    def solve(self, problem: ControlProblem) -> ControlSolution:
        """The test's answer."""
        self.problems.append(problem)
        answer = self.answer(problem) if callable(self.answer) else self.answer
        if isinstance(answer, ControlSolution):
            return answer
        plan = np.array(answer, dtype=float)
        if plan.ndim == 1:
            plan = np.tile(plan, (self.settings.horizon, 1))
        return ControlSolution(plan, self.status)
