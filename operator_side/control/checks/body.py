"""Whether a plan for z = x + lag v keeps the body x clear: what operator_side/margins/lag.py leaves to rare paths.

At every instant the body heads for z. If z stopped now, the body would run along the segment from x to z, and no
nearer to anything than that segment. So a plan is followed as far as the segment stays clear after each step; from
there z stands still, the body catches up, and the segment only shrinks. This holds for every path and any lag,
but for what the barrier's samples leave open anyway: a straight step of length s between two points at R passes
h = -s^2 / 4. That much is let pass; else a robot that stands on a margin could not go along it.
"""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from farhand.common.geometry import Array
from farhand.operator_side.control.controller import ControlProblem


def prepare() -> None:
    """Compile, or load from the cache; called before anything is connected."""
    nothing, none = np.zeros((0, 3)), np.zeros(0)
    still = ControlProblem(np.zeros(3), np.zeros(3), nothing, none, nothing, none)
    clear_steps(still, none, np.zeros((1, 3)), (np.zeros(3), 1.0, 1.0))


def clear_steps(
    problem: ControlProblem, radii: Array, plan: Array, motion: tuple[Array, float, float]
) -> int:
    """How many steps of the plan leave a clear segment between body and z, or one no nearer than standing still does.

    Args:
        problem: the tick's problem; its position is z.
        radii: (n,) in place of the problem's, that the body must keep (m).
        plan: (N, 3), m/s.
        motion: (3,) velocity of the body at the plan's beginning (m/s), its lag, length of a step (s).

    Raises ValueError for a plan of another shape.
    """
    velocity, lag, dt = motion
    if plan.ndim != 2 or plan.shape[1] != 3:
        raise ValueError(f"a plan is (N, 3), not {plan.shape}")
    obstacles = (_own(problem.centres), _own(problem.velocities), _own(radii), _own(problem.sigmas))
    arguments = _own(problem.position), _own(velocity), _own(plan), obstacles, (float(lag), float(dt))
    return int(_kernel()(*arguments))


def _own(array: Array) -> Array:
    """A copy of the one type that is compiled for, whatever a controller hands in: nothing compiles in a run."""
    return np.array(array, dtype=np.float64, order="C")


@cache
def _kernel() -> Callable[..., Any]:
    """Numba is imported here, for programs that check nothing."""
    from farhand.operator_side.control.checks import body_kernel

    return body_kernel.clear_steps  # type: ignore[no-any-return]
