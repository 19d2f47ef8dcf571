"""What compiled code reads of the obstacles: one row each, in place."""

from dataclasses import dataclass

from farhand.common.geometry import Array

COLUMNS = 24


@dataclass(frozen=True, slots=True)
class Surroundings:
    """All obstacles at one instant, in the base frame.

    Attributes:
        rows: (n, COLUMNS), C-order: 0 kind (0 sphere, 1 capsule, 2 box, 3 plane, 4 convex mesh); 1:4 position (m);
            4:13 R_base_shape, row-major; 13:16 size; 16:19 velocity (m/s); 19 bound of the acceleration (m/s^2);
            20 bounding radius about the position (m), infinite for planes; 21:24 spare.
        vertices: (m, 3) of the meshes, in their own frames (m).
        ids: of the obstacles, in the rows' order.
    """

    rows: Array
    vertices: Array
    ids: tuple[str, ...]
