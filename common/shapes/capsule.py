"""All points within a radius of a piece of its z axis: a post, a rail, a cable."""

import math

from msgspec import Struct

from farhand.common.quantities import Positive, Vector3


class Capsule(Struct, frozen=True, forbid_unknown_fields=True, tag_field="kind", tag="capsule"):
    """Attributes:
    radius: (m).
    half_length: of the piece of the z axis; the caps come on top (m).
    """

    radius: Positive
    half_length: Positive

    @property
    def bounding_radius(self) -> float:
        """Of the ball around the origin that holds all of it (m)."""
        return self.half_length + self.radius

    def distance(self, x: float, y: float, z: float) -> float:
        """From the surface to a point, negative inside (m); own frame."""
        over = max(0.0, abs(z) - self.half_length)
        return math.sqrt(x * x + y * y + over * over) - self.radius

    def witness(self, x: float, y: float, z: float) -> Vector3:
        """The point of the surface that is nearest to a point; own frame (m)."""
        axis = min(max(z, -self.half_length), self.half_length)
        along = z - axis
        norm = math.sqrt(x * x + y * y + along * along)
        if norm < 1e-12:
            return (self.radius, 0.0, axis)
        scale = self.radius / norm
        return (x * scale, y * scale, axis + along * scale)
