"""What it costs that the compiled solver knows planes: the kernel as it is beside itself without them, spheres only.

The second kernel is made from the first one's source, with "is it a plane" answered `False` while it is compiled.
"""

from collections.abc import Callable, Sequence
from itertools import pairwise
from types import ModuleType
from typing import Any
from unittest.mock import patch

import numba
import numpy as np

from farhand.common.timing.clock import thread_seconds
from farhand.operator_side.control import newton_kernel as kernel
from farhand.operator_side.control.controller import ControlProblem
from farhand.operator_side.control.newton import NewtonController
from farhand.operator_side.control.settings import ControllerSettings

IS_A_PLANE = "obstacles[j, FLAT] != 0.0"
ROUNDS = 5
"""Of all ticks; each tick counts with the fastest of its solves, as what disturbs only slows."""


def as_the_kernel(function: Callable[..., Any]) -> Any:
    """Compiled as the kernel's own functions are, but not kept."""
    return numba.njit(nogil=True, fastmath=False, error_model="numpy")(function)


def without_planes(compiled: Callable[..., Any] = as_the_kernel) -> ModuleType:
    """The kernel for spheres only, its functions decorated with `compiled`."""
    with open(kernel.__file__, encoding="utf-8") as file:
        source = file.read()
    if IS_A_PLANE not in source:
        raise RuntimeError(f"the kernel does not ask {IS_A_PLANE!r} any more")
    spheres = ModuleType("newton_kernel_of_spheres")
    with patch("farhand.operator_side.control.compile_cache.compiled", compiled):
        exec(compile(source.replace(IS_A_PLANE, "False"), spheres.__name__, "exec"), vars(spheres))
    return spheres


def in_turn(
    problems: Sequence[ControlProblem], settings: ControllerSettings, other: ModuleType, rounds: int = ROUNDS
) -> tuple[Any, Any]:
    """Seconds of each tick (n,) with the kernel, and with the other one, which take turns at going first.

    Raises RuntimeError where they differ in an answer.
    """
    seconds = np.full((2, len(problems)), np.inf)
    for turn in range(rounds):
        pair = (NewtonController(settings), kernel.solve), (NewtonController(settings), other.solve)
        fresh = [True, *(one.centres is not other.centres for one, other in pairwise(problems))]
        for index, problem in enumerate(problems):
            plans = [None, None]
            for which in (0, 1) if (index + turn) % 2 else (1, 0):
                controller, solve = pair[which]
                if fresh[index]:
                    controller.reset()
                with patch.object(kernel, "solve", solve):
                    began = thread_seconds()
                    plans[which] = controller.solve(problem).plan
                    spent = thread_seconds() - began
                seconds[which, index] = min(seconds[which, index], spent)
            if not np.array_equal(*plans):
                raise RuntimeError(f"the kernels differ at tick {index}")
    return seconds[0], seconds[1]
