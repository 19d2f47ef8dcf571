"""The obstacles as a table of numbers, for code that is compiled."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from farhand.common.geometry import Array
from farhand.common.messages.scene import Obstacle
from farhand.common.shapes.box import Box
from farhand.common.shapes.capsule import Capsule
from farhand.common.shapes.mesh import Mesh
from farhand.common.shapes.plane import Plane
from farhand.common.shapes.pose import rotation
from farhand.common.shapes.shape import Shape
from farhand.common.shapes.sphere import Sphere

COLUMNS = 24
SPHERE, CAPSULE, BOX, PLANE, MESH = range(5)
KIND, POSITION, ROTATION, SIZE, VELOCITY, ACCELERATION, BOUND = 0, 1, 4, 13, 16, 19, 20


@dataclass(frozen=True, slots=True, eq=False)
class Surroundings:
    """All obstacles at one instant; one object for a whole run, of which only the rows of movers change.

    Attributes:
        rows: (n, 24) C-order, an obstacle a row:
            0 kind: 0 sphere, 1 capsule, 2 box, 3 plane, 4 convex mesh
            1:4 position (m)
            4:13 R_base_shape, row by row
            13:16 sphere (radius, 0, 0), capsule (radius, half length, 0), box half extents, plane zeros,
                mesh (index of its first vertex, number of its vertices, 0)
            16:19 velocity now (m/s)
            19 bound on its acceleration (m/s^2)
            20 radius of the ball around `position` that holds all of it (m); infinite for planes
            21:24 zeros
        vertices: (m, 3) corners of all meshes, each in its own frame (m).
        ids: the obstacles' names, row by row.
    """

    rows: Array
    vertices: Array
    ids: tuple[str, ...]

    def move(self, index: int, position: Sequence[float], velocity: Sequence[float]) -> None:
        """Put one obstacle elsewhere (m, m/s)."""
        row = self.rows[index]
        row[POSITION : POSITION + 3] = position
        row[VELOCITY : VELOCITY + 3] = velocity


def surroundings_of(obstacles: Sequence[Obstacle]) -> Surroundings:
    """The table of these obstacles, where they are said to be."""
    rows = np.zeros((len(obstacles), COLUMNS))
    corners: list[Array] = []
    first = 0
    for row, obstacle in zip(rows, obstacles, strict=True):
        shape = obstacle.shape
        row[KIND], row[SIZE : SIZE + 3] = _measures(shape)
        if isinstance(shape, Mesh):
            row[SIZE] = first
            corners.append(shape.points)
            first += len(shape.points)
        row[POSITION : POSITION + 3] = obstacle.position
        row[ROTATION : ROTATION + 9] = np.ravel(rotation(obstacle.orientation))
        row[VELOCITY : VELOCITY + 3] = obstacle.velocity
        row[ACCELERATION] = obstacle.acceleration
        row[BOUND] = shape.bounding_radius
    vertices = np.ascontiguousarray(np.vstack(corners)) if corners else np.zeros((0, 3))
    return Surroundings(rows, vertices, tuple(o.id for o in obstacles))


def _measures(shape: Shape) -> tuple[int, tuple[float, float, float]]:
    """Kind, and what stands in columns 13 to 16 (of a mesh without its first vertex)."""
    if isinstance(shape, Sphere):
        return SPHERE, (shape.radius, 0.0, 0.0)
    if isinstance(shape, Capsule):
        return CAPSULE, (shape.radius, shape.half_length, 0.0)
    if isinstance(shape, Box):
        return BOX, shape.half_extents
    if isinstance(shape, Plane):
        return PLANE, (0.0, 0.0, 0.0)
    return MESH, (0.0, float(len(shape.points)), 0.0)
