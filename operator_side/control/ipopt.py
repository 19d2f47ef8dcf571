"""MPC-CBF by Ipopt on the full problem: the oracle, and the paper's way of solving it."""

from collections.abc import Callable
from typing import Any

import casadi

from farhand.operator_side.control.nlp_controller import NlpController
from farhand.operator_side.control.settings import ControllerSettings
from farhand.operator_side.control.statement import SymbolicProblem, state_problem


class IpoptController(NlpController):
    """Every obstacle, every state, omega: nothing pruned, nothing condensed, no shortcut.

    A program is built when a number of obstacles is first seen. Ipopt stops at settings.wall_time_limit: on
    an infeasible problem it would run for seconds.
    """

    def __init__(self, settings: ControllerSettings, warm: bool = True) -> None:
        """Keep the settings; without `warm` every tick starts anew, as the paper ran it."""
        super().__init__(settings, warm)
        self._programs: dict[int, tuple[SymbolicProblem, Callable[..., Any]]] = {}

    def _program(self, count: int) -> tuple[SymbolicProblem, Callable[..., Any]]:
        if count not in self._programs:
            symbolic = state_problem(self.settings, count, condensed=False)
            options: dict[str, Any] = {
                "ipopt.print_level": 0,
                "ipopt.sb": "yes",
                "ipopt.max_wall_time": self.settings.wall_time_limit,
                "print_time": False,
                "error_on_fail": False,
            }
            self._programs[count] = symbolic, casadi.nlpsol("ipopt", "ipopt", symbolic.nlp, options)
        return self._programs[count]
