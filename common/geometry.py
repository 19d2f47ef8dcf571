"""Small vector helpers. Vectors are numpy arrays of shape (3,), base frame, SI units."""

import math
from collections.abc import Iterable
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]
Vector3: TypeAlias = tuple[float, float, float]


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
