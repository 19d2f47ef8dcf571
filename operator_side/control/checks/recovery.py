"""What is solved when the robot already stands inside a margin, as it does whenever a margin grows over it.

From inside, the paper's problem has "through the obstacle" among its optima, and standing still for ever is no
answer either. So each margin that holds the robot is drawn back to where it stands, which forbids going deeper, and
the desired velocity is turned outwards: along each such margin's normal n it shall be at least

    v_out = min(gamma depth / dt, half the speed limit),

the rate at which the discrete barrier with omega = 1 leaves the inside. All of it is scaled into the speed limits:
a limit that cuts one axis alone would turn the velocity, and inwards as well as not.
"""

from dataclasses import replace

import numpy as np

from farhand.common.geometry import Array
from farhand.operator_side.control import barrier as rows
from farhand.operator_side.control.controller import ControlProblem
from farhand.operator_side.control.settings import ControllerSettings

JUST_OUTSIDE = 1.0 - 1e-4


def eased(problem: ControlProblem, settings: ControllerSettings) -> ControlProblem | None:
    """The problem to be solved instead, or None when the start is outside every margin."""
    if rows.starts_clear(problem):
        return None
    gaps, outward = rows.gaps(problem)
    reach = rows.reaches(problem)
    inside = (gaps < reach) & ((gaps > 1e-6) | (problem.flat != 0.0))
    if not inside.any():
        return None
    fastest = 0.5 * min(settings.speed_limit)
    limits = np.array(settings.speed_limit)
    desired = _within(problem.desired, limits)
    for j in sorted(np.flatnonzero(inside), key=lambda k: gaps[k] - reach[k], reverse=True):
        normal = outward[j]
        wanted = min(settings.gamma * (reach[j] - gaps[j]) / settings.period, fastest)
        wanted += float(normal @ problem.velocities[j])
        desired = desired + normal * max(0.0, wanted - float(normal @ desired))
    # A plane that the robot is below is drawn back to the robot itself.
    below = np.minimum(gaps, 0.0)
    return replace(
        problem,
        desired=_within(desired, limits),
        centres=problem.centres + outward * below[:, None] if np.any(below) else problem.centres,
        radii=np.where(inside, np.maximum(gaps, 0.0) * JUST_OUTSIDE, problem.radii),
        sigmas=np.where(inside, 0.0, problem.sigmas),
    )


def _within(velocity: Array, limits: Array) -> Array:
    """The velocity, scaled down until no axis exceeds its limit (m/s)."""
    scaled: Array = velocity / max(1.0, float(np.max(np.abs(velocity) / limits)))
    return scaled
