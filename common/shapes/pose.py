"""Where a shape is: rotations from quaternions, points into its frame and out of it."""

import math

from farhand.common.quantities import Quaternion, Vector3

UPRIGHT: Quaternion = (1.0, 0.0, 0.0, 0.0)
Rows = tuple[Vector3, Vector3, Vector3]


def rotation(orientation: Quaternion) -> Rows:
    """R_base_shape, row by row, of a quaternion (w, x, y, z) of about unit length."""
    norm = math.sqrt(sum(q * q for q in orientation))
    w, x, y, z = (q / norm for q in orientation)
    return (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )


def into(rows: Rows, position: Vector3, point: Vector3) -> Vector3:
    """A point of the base frame in the frame of a shape at `position`."""
    dx, dy, dz = point[0] - position[0], point[1] - position[1], point[2] - position[2]
    (a, b, c), (d, e, f), (g, h, i) = rows
    return (a * dx + d * dy + g * dz, b * dx + e * dy + h * dz, c * dx + f * dy + i * dz)


def out_of(rows: Rows, position: Vector3, point: Vector3) -> Vector3:
    """A point of the frame of a shape at `position` in the base frame."""
    (a, b, c), (d, e, f), (g, h, i) = rows
    x, y, z = point
    return (
        position[0] + a * x + b * y + c * z,
        position[1] + d * x + e * y + f * z,
        position[2] + g * x + h * y + i * z,
    )
