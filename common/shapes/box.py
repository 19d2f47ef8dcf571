"""A box around its origin, its edges along its axes."""

import math

from msgspec import Struct

from farhand.common.quantities import Positive, Vector3


class Box(Struct, frozen=True, forbid_unknown_fields=True, tag_field="kind", tag="box"):
    """Attributes:
    half_extents: half of its length along x, y and z (m).
    """

    half_extents: tuple[Positive, Positive, Positive]

    @property
    def bounding_radius(self) -> float:
        """Of the ball around the origin that holds all of it (m)."""
        return math.hypot(*self.half_extents)

    def distance(self, x: float, y: float, z: float) -> float:
        """From the surface to a point, negative inside (m); own frame."""
        a, b, c = self.half_extents
        dx, dy, dz = abs(x) - a, abs(y) - b, abs(z) - c
        inside = max(dx, dy, dz)
        if inside <= 0.0:
            return inside
        dx, dy, dz = max(dx, 0.0), max(dy, 0.0), max(dz, 0.0)
        return math.sqrt(dx * dx + dy * dy + dz * dz)

    def witness(self, x: float, y: float, z: float) -> Vector3:
        """The point of the surface that is nearest to a point; own frame (m)."""
        point, half = (x, y, z), self.half_extents
        depth = [h - abs(p) for p, h in zip(point, half, strict=True)]
        nearest = [min(max(p, -h), h) for p, h in zip(point, half, strict=True)]
        if min(depth) > 0.0:
            axis = depth.index(min(depth))
            nearest[axis] = math.copysign(half[axis], point[axis])
        return (nearest[0], nearest[1], nearest[2])
