"""What a margin law, a prediction law, a device or a controller got wrong, in one line: it must not reach the robot."""

import math

import numpy as np

from farhand.common.errors import FarhandError, in_one_line
from farhand.common.geometry import Array
from farhand.operator_side.margins.law import Margin
from farhand.operator_side.steering.device import SteeringInput


class KindError(FarhandError):
    """A kind broke the promise of its interface."""


def checked_margin(margin: Margin) -> Margin:
    """The margin itself; raises KindError unless it makes obstacles larger by finite lengths."""
    for name, value in (("sigma", margin.sigma), ("inflation", margin.inflation)):
        if not (math.isfinite(value) and value >= 0.0):
            raise KindError(f"the margin law gave {name} {value!r}; it must be finite and at least 0")
    for name, value in margin.parts.items():
        if not (isinstance(name, str) and isinstance(value, float | int) and math.isfinite(value)):
            raise KindError(
                f"the margin law gave a part {name!r} of {value!r}; it must be a finite length (m)"
            )
    return margin


def checked_steering(steering: SteeringInput) -> SteeringInput:
    """What the device wants; raises KindError unless it is a SteeringInput of finite numbers."""
    if not isinstance(steering, SteeringInput):
        raise KindError(f"the steering device gave {steering!r}; it must be a SteeringInput")
    velocity = steering.velocity
    if len(velocity) != 3 or not all(map(math.isfinite, velocity)):
        raise KindError(f"the steering device wants {velocity!r}; it must be three finite numbers (m/s)")
    angular = steering.angular
    if len(angular) != 3 or not all(map(math.isfinite, angular)):
        raise KindError(
            f"the steering device wants to turn at {angular!r}; it must be three finite numbers (rad/s)"
        )
    return steering


def checked_plan(plan: Array, horizon: int) -> None:
    """Raise KindError unless a plan is (horizon, 3) finite velocities (m/s)."""
    if plan.shape != (horizon, 3) or not np.isfinite(plan).all():
        raise KindError(
            f"the controller gave a plan of shape {plan.shape}; it must be ({horizon}, 3) finite numbers"
        )


def told(error: Exception) -> str:
    """What was raised, and in which line of whose file."""
    return str(error) if isinstance(error, KindError) else in_one_line(error)
