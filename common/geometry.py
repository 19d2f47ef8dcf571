"""Small vector helpers. Vectors are numpy arrays of shape (3,), base frame, SI units."""

import math
from collections.abc import Iterable
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]
Vector3: TypeAlias = tuple[float, float, float]
Quaternion: TypeAlias = tuple[float, float, float, float]


class Twist(NamedTuple):
    """Velocity of the tool, expressed in the base frame and taken at the tool's own point.

    Attributes:
        linear: (m/s).
        angular: about base's axes, right-handed (rad/s).
    """

    linear: Vector3 = (0.0, 0.0, 0.0)
    angular: Vector3 = (0.0, 0.0, 0.0)


STILL = Twist()


def turned(orientation: Quaternion, turn: Vector3) -> Quaternion:
    """An orientation after a turn about base's axes.

    Args:
        orientation: unit quaternion (w, x, y, z).
        turn: rotation vector in base (rad), such as an angular velocity times a duration.

    Returns a unit quaternion.
    """
    angle = norm(turn)
    if angle == 0.0:
        return orientation
    half = 0.5 * angle
    scale = math.sin(half) / angle
    x, y, z = (scale * value for value in turn)
    w, (a, b, c, d) = math.cos(half), orientation
    product = (
        w * a - x * b - y * c - z * d,
        w * b + x * a + y * d - z * c,
        w * c - x * d + y * a + z * b,
        w * d + x * c - y * b + z * a,
    )
    length = norm(product)
    w, x, y, z = (value / length for value in product)
    return (w, x, y, z)


def turn_between(orientation: Quaternion, wanted: Quaternion) -> Vector3:
    """The shortest rotation vector in base (rad) that turns one orientation into another (unit quaternions)."""
    (a, b, c, d), (w, x, y, z) = orientation, wanted
    # wanted * conjugate(orientation)
    real = w * a + x * b + y * c + z * d
    axis = (
        -w * b + x * a - y * d + z * c,
        -w * c + x * d + y * a - z * b,
        -w * d - x * c + y * b + z * a,
    )
    sine = norm(axis)
    if sine < 1e-12:
        return (0.0, 0.0, 0.0)
    scale = 2.0 * math.atan2(sine, abs(real)) / sine * (1.0 if real >= 0.0 else -1.0)
    return (axis[0] * scale, axis[1] * scale, axis[2] * scale)


def to_vector3(values: Iterable[float]) -> Vector3:
    """A tuple of three plain floats."""
    x, y, z = values
    return (float(x), float(y), float(z))


def norm(values: Iterable[float]) -> float:
    """Euclidean norm of a vector of any length."""
    return math.sqrt(sum([v * v for v in values]))


def distance(a: Iterable[float], b: Iterable[float]) -> float:
    """Euclidean distance of two points."""
    return math.dist(tuple(a), tuple(b))
