"""The turning that is sent beside a filtered plan: within its limit, and no longer than the plan moves."""

import numpy as np

from farhand.common.geometry import norm
from farhand.common.messages.base import ZERO, Vector3
from farhand.operator_side.safety_filter import Filtered


def limited(angular: Vector3, limit: float) -> Vector3:
    """The same axis, at most `limit` rad/s fast."""
    rate = norm(angular)
    if rate <= limit:
        return angular
    x, y, z = angular
    scale = limit / rate
    return (x * scale, y * scale, z * scale)


def turning_plan(
    angular: Vector3, limit: float, filtered: Filtered | None, horizon: int
) -> tuple[Vector3, ...]:
    """The angular velocity for each period of a plan (rad/s).

    It is held through the plan, so that a lost command does not break a turn off; but where safety stops the tool or
    cuts the plan off, the turning stops with it: the sphere around the tool does not change by turning, the
    rest of the body does. Without a plan nothing turns.

    Args:
        angular: that is wanted (rad/s).
        limit: (rad/s).
        filtered: the plan; None: the robot shall stand.
        horizon: periods of a plan.
    """
    if filtered is None or angular == ZERO:
        return ()
    moving = horizon
    if filtered.reason:
        driven = np.flatnonzero(np.any(filtered.plan != 0.0, axis=1))
        moving = int(driven[-1]) + 1 if driven.size else 0
    return (limited(angular, limit),) * moving
