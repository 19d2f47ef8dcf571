"""A ball around its origin."""

import math

from msgspec import Struct

from farhand.common.quantities import Positive, Vector3


class Sphere(Struct, frozen=True, forbid_unknown_fields=True, tag_field="kind", tag="sphere"):
    """Attributes:
    radius: (m).
    """

    radius: Positive

    @property
    def bounding_radius(self) -> float:
        """Of the ball around the origin that holds all of it (m)."""
        return self.radius

    def distance(self, x: float, y: float, z: float) -> float:
        """From the surface to a point, negative inside (m); own frame."""
        return math.sqrt(x * x + y * y + z * z) - self.radius

    def witness(self, x: float, y: float, z: float) -> Vector3:
        """The point of the surface that is nearest to a point; own frame (m)."""
        norm = math.sqrt(x * x + y * y + z * z)
        if norm < 1e-12:
            return (0.0, 0.0, self.radius)
        scale = self.radius / norm
        return (x * scale, y * scale, z * scale)
