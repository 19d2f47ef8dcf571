"""Random scenes of every shape, standing and shuttling, around a place where a robot starts."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from numpy.random import Generator

from farhand.common.geometry import Array, Vector3, to_vector3
from farhand.common.shapes.box import Box
from farhand.common.shapes.capsule import Capsule
from farhand.common.shapes.mesh import Mesh
from farhand.common.shapes.obstacle import Obstacle
from farhand.common.shapes.plane import Plane
from farhand.common.shapes.shape import Shape
from farhand.common.shapes.sphere import Sphere

TRIES = 400
MOVER_ACCELERATION = (1.0, 4.0)  # m/s^2


def draw_shape(rng: Generator, size: tuple[float, float]) -> Shape:
    """A sphere, capsule, box or convex mesh whose half lengths lie between two sizes (m)."""
    kind = rng.integers(4)
    x, y, z = (float(value) for value in rng.uniform(*size, 3))
    if kind == 0:
        return Sphere(x)
    if kind == 1:
        return Capsule(0.5 * x, y)
    if kind == 2:
        return Box((x, y, z))
    corners = rng.normal(size=(int(rng.integers(8, 24)), 3))
    corners *= np.array([x, y, z]) / np.linalg.norm(corners, axis=1, keepdims=True)
    return Mesh(tuple(to_vector3(corner) for corner in corners))


def draw_orientation(rng: Generator) -> tuple[float, float, float, float]:
    """Any, evenly: a unit quaternion (w, x, y, z)."""
    q = rng.normal(size=4)
    w, x, y, z = (float(value) for value in q / np.linalg.norm(q))
    return (w, x, y, z)


def draw_scene(
    rng: Generator,
    *,
    count: int,
    place: Callable[[Generator], Array],
    size: tuple[float, float],
    speed: float,
    fits: Callable[[Obstacle], bool],
) -> tuple[Obstacle, ...]:
    """`count` obstacles; where `speed` is above 0, half of them shuttle.

    Args:
        rng: of this scene.
        count: of obstacles, planes not counted.
        place: draws a position (3,), m.
        size: least and greatest half length (m).
        speed: of those that move (m/s).
        fits: whether an obstacle may be there: clear of the robot's start, and of what cannot step aside.
    """
    found: list[Obstacle] = []
    for _ in range(TRIES):
        if len(found) == count:
            break
        moves = speed > 0.0 and 2 * len(found) < count
        name = f"{'mover' if moves else 'post'}-{len(found)}"
        obstacle = draw_obstacle(rng, name, place, size, speed if moves else 0.0)
        if fits(obstacle):
            found.append(obstacle)
    return tuple(found)


def draw_obstacle(
    rng: Generator, name: str, place: Callable[[Generator], Array], size: tuple[float, float], speed: float
) -> Obstacle:
    """One that stands, or one that shuttles between two or three places."""
    shape, orientation = draw_shape(rng, size), draw_orientation(rng)
    if speed <= 0.0:
        return Obstacle(
            id=name, shape=shape, orientation=orientation, position=to_vector3(place(rng).tolist())
        )
    path = tuple(to_vector3(place(rng).tolist()) for _ in range(int(rng.integers(2, 4))))
    acceleration = float(rng.uniform(*MOVER_ACCELERATION))
    return Obstacle(
        id=name, shape=shape, orientation=orientation, path=path, speed=speed, acceleration=acceleration
    )


def plane(name: str, point: Vector3, normal: Array) -> Obstacle:
    """A plane through a point (m), free on the side to which a unit vector (3,) points."""
    w = 1.0 + float(normal[2])
    if w < 1e-9:
        return Obstacle(id=name, shape=Plane(), position=point, orientation=(0.0, 1.0, 0.0, 0.0))
    q = np.array([w, -normal[1], normal[0], 0.0])
    q /= np.linalg.norm(q)
    return Obstacle(
        id=name,
        shape=Plane(),
        position=point,
        orientation=(float(q[0]), float(q[1]), float(q[2]), float(q[3])),
    )


def sampled(obstacle: Obstacle, spacing: float = 0.02) -> list[Obstacle]:
    """The obstacle at places all along its way, `spacing` apart (m); itself alone where it stands."""
    if not obstacle.path:
        return [obstacle]
    corners = [np.array(point) for point in obstacle.path]
    places = []
    for start, end in pairwise(corners):
        steps = max(2, int(np.linalg.norm(end - start) / spacing) + 1)
        places += [start + share * (end - start) for share in np.linspace(0.0, 1.0, steps)]
    return [
        Obstacle(
            id=obstacle.id,
            shape=obstacle.shape,
            orientation=obstacle.orientation,
            position=to_vector3(where.tolist()),
        )
        for where in places
    ]
