"""Ways round what stands in the way: the wanted velocity, turned to a side until it is free.

Sides are those of who looks along the wanted velocity with base's z up; where it points up or down itself, with base's
x ahead.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from farhand.common.geometry import norm
from farhand.common.messages.base import Vector3

Free = Callable[[Sequence[Vector3]], Sequence[bool]]
"""Of each velocity (m/s), whether the filter would let it pass nearly as it is."""

SIDES = ("left", "right", "above", "below")
OTHER = {"left": "right", "right": "left", "above": "below", "below": "above"}
STEP = 0.05
"""Rad, in which a free angle is looked for."""
MOST = 4.2
"""The largest angle that is tried (rad): out of a pocket one goes back, and a little more."""
_UPRIGHT = 0.95
"""Of the way's unit vector along z, from which it counts as upright."""


@dataclass(frozen=True, slots=True)
class WayRound:
    """Attributes:
    side: one of SIDES.
    angle: the smallest by which the velocity must be turned to be free (rad).
    """

    side: str
    angle: float


def everything_is_free(velocities: Sequence[Vector3]) -> Sequence[bool]:
    """For devices that are read without a filter."""
    return [True] * len(velocities)


def towards(velocity: Vector3, side: str) -> Vector3:
    """The unit vector across a velocity that points to a side."""
    speed = norm(velocity)
    ahead = (velocity[0] / speed, velocity[1] / speed, velocity[2] / speed)
    up = (0.0, 0.0, 1.0) if abs(ahead[2]) < _UPRIGHT else (-math.copysign(1.0, ahead[2]), 0.0, 0.0)
    left = _cross(up, ahead)
    length = norm(left)
    left = (left[0] / length, left[1] / length, left[2] / length)
    vector = left if side in ("left", "right") else _cross(ahead, left)
    sign = 1.0 if side in ("left", "above") else -1.0
    return (sign * vector[0], sign * vector[1], sign * vector[2])


def turned_towards(velocity: Vector3, across: Vector3, angle: float) -> Vector3:
    """A velocity turned by `angle` (rad) towards a direction, as fast as before.

    Args:
        velocity: (m/s), not zero.
        across: where to; its part along the velocity does not matter.
        angle: (rad).
    """
    speed = norm(velocity)
    along = sum(a * v for a, v in zip(across, velocity, strict=True)) / speed**2
    side = [a - along * v for a, v in zip(across, velocity, strict=True)]
    length = norm(side)
    if length < 1e-9:
        return velocity
    c, s = math.cos(angle), math.sin(angle) * speed / length
    x, y, z = (c * v + s * a for v, a in zip(velocity, side, strict=True))
    return (x, y, z)


def way_round(velocity: Vector3, free: Free) -> WayRound | None:
    """The side with the smallest free angle, the first of SIDES among equals; None where no side has one."""
    angles = [STEP * k for k in range(1, round(MOST / STEP) + 1)]
    found: list[WayRound] = []
    for side in SIDES:
        across = towards(velocity, side)
        verdicts = free([turned_towards(velocity, across, angle) for angle in angles])
        first = next((angle for angle, verdict in zip(angles, verdicts, strict=True) if verdict), None)
        if first is not None:
            found.append(WayRound(side, first))
    return min(found, key=lambda way: way.angle, default=None)


def _cross(a: Vector3, b: Vector3) -> Vector3:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
