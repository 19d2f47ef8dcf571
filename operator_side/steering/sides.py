"""Ways round what stands in the way: the wanted velocity, turned to a side until it is free.

Sides are those of who looks along the wanted velocity with base's z up; where it points up or down itself, with base's
x ahead.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from farhand.common.geometry import Array, norm
from farhand.common.messages.base import Vector3

Free = Callable[[Array | Sequence[Vector3]], Sequence[bool]]
"""Of velocities (k, 3), m/s, whether the filter would let each pass nearly as it is: (k,)."""

SIDES = ("left", "right", "above", "below")
OTHER = {"left": "right", "right": "left", "above": "below", "below": "above"}
STEP = 0.05
"""Rad, in which a free angle is looked for."""
MOST = 4.2
"""The largest angle that is tried (rad): out of a pocket one goes back, and a little more."""
ANGLES = tuple(STEP * k for k in range(round(MOST / STEP) + 1))
"""What is tried (rad), from straight on."""
_TURNS = np.array([(math.cos(angle), math.sin(angle)) for angle in ANGLES])
_AT_ONCE = 28
"""So many angles to every side are asked about at once: most ways round are found among the first."""
_ALONG = 1e-9
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


def everything_is_free(velocities: Array | Sequence[Vector3]) -> Sequence[bool]:
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
    side, length = _aside(velocity, across)
    if length < _ALONG:
        return velocity
    c, s = math.cos(angle), math.sin(angle) * norm(velocity) / length
    x, y, z = (c * v + s * a for v, a in zip(velocity, side, strict=True))
    return (x, y, z)


def fan(velocity: Vector3, across: Vector3) -> Array:
    """(k, 3) a velocity turned by each of ANGLES towards a direction; see turned_towards."""
    v, (side, length) = np.array(velocity), _aside(velocity, across)
    if length < _ALONG:
        return np.tile(v, (len(ANGLES), 1))
    turned: Array = _TURNS[:, :1] * v + _TURNS[:, 1:] * (norm(velocity) / length * np.array(side))
    return turned


def way_round(velocity: Vector3, free: Free) -> WayRound | None:
    """The side with the smallest free angle, the first of SIDES among equals; None where no side has one."""
    fans = np.stack([fan(velocity, towards(velocity, side)) for side in SIDES], axis=1)
    for first in range(1, len(ANGLES), _AT_ONCE):
        some = fans[first : first + _AT_ONCE]
        verdicts = free(some.reshape(-1, 3))
        found = next((index for index, verdict in enumerate(verdicts) if verdict), None)
        if found is not None:
            return WayRound(SIDES[found % len(SIDES)], ANGLES[first + found // len(SIDES)])
    return None


def _aside(velocity: Vector3, across: Vector3) -> tuple[Vector3, float]:
    """The part of a direction that is across a velocity, and its length."""
    along = sum(a * v for a, v in zip(across, velocity, strict=True)) / norm(velocity) ** 2
    x, y, z = (a - along * v for a, v in zip(across, velocity, strict=True))
    return (x, y, z), norm((x, y, z))


def _cross(a: Vector3, b: Vector3) -> Vector3:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
