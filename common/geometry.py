"""Small vector helpers. Vectors are numpy arrays of shape (3,), base frame, SI units."""

import math
from collections.abc import Iterable
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from farhand.common.messages.base import Vector3

Array: TypeAlias = NDArray[np.float64]


def to_vector3(values: Iterable[float]) -> Vector3:
    """A tuple of three plain floats."""
    x, y, z = values
    return (float(x), float(y), float(z))


def norm(values: Iterable[float]) -> float:
    """Euclidean norm of a vector of any length."""
    return math.sqrt(sum(v * v for v in values))


def distance(a: Iterable[float], b: Iterable[float]) -> float:
    """Euclidean distance of two points."""
    return math.dist(tuple(a), tuple(b))


def sphere_clearance(point: Vector3, radius: float, centres: Array, radii: Array) -> float:
    """Distance from a sphere at `point` to the nearest of n spheres (m); 1e6 when there are none.

    Args:
        point: centre of the sphere (m).
        radius: its radius (m).
        centres: (n, 3), m.
        radii: (n,), m.
    """
    if len(radii) == 0:
        return 1e6
    return float(np.min(np.sqrt(np.sum((centres - np.asarray(point)) ** 2, axis=1)) - radii)) - radius
