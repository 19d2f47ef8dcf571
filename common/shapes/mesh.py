"""A convex body given by its corners."""

from functools import cached_property
from typing import Annotated

import numpy as np
from msgspec import Meta, Struct

from farhand.common.geometry import Array, to_vector3
from farhand.common.quantities import Vector3
from farhand.common.shapes.hull import Hull, hull_of

MAX_VERTICES = 256


class Mesh(Struct, frozen=True, dict=True, forbid_unknown_fields=True, tag_field="kind", tag="mesh"):
    """The convex hull of its vertices; a `file` of STL or OBJ in a scenario is read into them.

    Attributes:
        vertices: (m); those inside of the hull change nothing.
    """

    vertices: Annotated[tuple[Vector3, ...], Meta(min_length=4, max_length=MAX_VERTICES)]

    def __post_init__(self) -> None:
        points = np.array(self.vertices)
        extent = np.ptp(points, axis=0)
        if not np.isfinite(extent).all():
            raise ValueError("vertices: must be finite numbers")
        _ = self.hull  # raises NoHullError, a ValueError, for a flat one

    @cached_property
    def hull(self) -> Hull:
        """Its faces."""
        return hull_of(np.array(self.vertices))

    @cached_property
    def points(self) -> Array:
        """(n, 3) the corners of the hull (m)."""
        return np.array([self.vertices[index] for index in self.hull.used])

    @cached_property
    def bounding_radius(self) -> float:
        """Of the ball around the origin that holds all of it (m)."""
        return float(np.sqrt((self.points**2).sum(axis=1)).max())

    def distance(self, x: float, y: float, z: float) -> float:
        """From the surface to a point, negative inside (m); own frame."""
        return self.hull.distance(x, y, z)

    def witness(self, x: float, y: float, z: float) -> Vector3:
        """The point of the surface that is nearest to a point; own frame (m)."""
        return to_vector3(self.hull.witness(x, y, z))
