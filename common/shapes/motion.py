"""To and fro along a path: a pure function of time."""

import math
from bisect import bisect_right
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

from farhand.common.quantities import ZERO, Vector3

MIN_LEG = 1e-3
"""Way-points nearer to each other than this are refused (m)."""


@dataclass(frozen=True, slots=True)
class Leg:
    """From one way-point to the next, at rest at both: starting, going on, braking.

    Attributes:
        start: where it begins (m).
        direction: unit vector.
        length: (m).
        ramp: for how long it starts, and as long it brakes (s).
        duration: of all of it (s).
        acceleration: while it starts and brakes (m/s^2).
    """

    start: Vector3
    direction: Vector3
    length: float
    ramp: float
    duration: float
    acceleration: float

    def at(self, t: float) -> tuple[float, float]:
        """Distance covered and speed, `t` s after its beginning (m, m/s)."""
        a, ramp = self.acceleration, self.ramp
        if t < ramp:
            return 0.5 * a * t * t, a * t
        left = self.duration - t
        if left < ramp:
            return self.length - 0.5 * a * left * left, a * left
        return a * ramp * (t - 0.5 * ramp), a * ramp


@dataclass(frozen=True, slots=True)
class Shuttle:
    """Attributes:
    legs: there and back again.
    begins: instants at which they begin (s).
    period: of all of it (s).
    """

    legs: tuple[Leg, ...]
    begins: tuple[float, ...]
    period: float

    def at(self, t: float) -> tuple[Vector3, Vector3]:
        """Position and velocity `t` s after it left the first way-point (m, m/s)."""
        t = t % self.period
        index = bisect_right(self.begins, t) - 1
        leg = self.legs[index]
        covered, speed = leg.at(min(t - self.begins[index], leg.duration))
        (x, y, z), (u, v, w) = leg.start, leg.direction
        position = (x + covered * u, y + covered * v, z + covered * w)
        return position, (speed * u, speed * v, speed * w)


@lru_cache(maxsize=1024)
def shuttle(path: tuple[Vector3, ...], speed: float, acceleration: float) -> Shuttle:
    """The motion along a path.

    Args:
        path: way-points (m).
        speed: between them (m/s); a leg that is too short for it is driven more slowly.
        acceleration: with which it starts and brakes (m/s^2).

    Raises:
        ValueError: no motion, in words that name the key.
    """
    if len(path) < 2:
        raise ValueError(f"path: a shuttle needs at least two way-points, there is {len(path) or 'none'}")
    if not speed > 0.0:
        raise ValueError("speed: a shuttle needs one above 0 m/s")
    if not acceleration > 0.0:
        raise ValueError("acceleration: a shuttle stops at its way-points, and needs one above 0 m/s^2")
    legs = [_leg(a, b, speed, acceleration) for a, b in pairwise((*path, *path[-2::-1]))]
    begins, total = [], 0.0
    for leg in legs:
        begins.append(total)
        total += leg.duration
    return Shuttle(tuple(legs), tuple(begins), total)


def _leg(start: Vector3, end: Vector3, speed: float, acceleration: float) -> Leg:
    length = math.dist(start, end)
    if not length >= MIN_LEG:
        raise ValueError(f"path: two way-points in a row are one, {list(start)}")
    direction = tuple((e - s) / length for s, e in zip(start, end, strict=True))
    ramp = min(speed / acceleration, math.sqrt(length / acceleration))
    duration = 2 * ramp + (length - acceleration * ramp * ramp) / (acceleration * ramp)
    return Leg(start, direction or ZERO, length, ramp, duration, acceleration)  # type: ignore[arg-type]
