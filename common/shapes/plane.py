"""A half-space: all that lies below its xy-plane, such as a table, or what is behind a wall."""

import math

from msgspec import Struct

from farhand.common.quantities import Vector3


class Plane(Struct, frozen=True, forbid_unknown_fields=True, tag_field="kind", tag="plane"):
    """Free is the side to which its z axis points; all below is solid, however deep."""

    @property
    def bounding_radius(self) -> float:
        """It has no end."""
        return math.inf

    def distance(self, x: float, y: float, z: float) -> float:
        """From the surface to a point, negative below it (m); own frame."""
        return z

    def witness(self, x: float, y: float, z: float) -> Vector3:
        """The point of the surface that is nearest to a point; own frame (m)."""
        return (x, y, 0.0)
