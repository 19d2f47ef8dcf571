"""Shapes, placed, as Foxglove's primitives."""

import math
from collections.abc import Iterable
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from foxglove.messages import (
    Color,
    CubePrimitive,
    CylinderPrimitive,
    KeyValuePair,
    Point3,
    Pose,
    Quaternion,
    SceneEntity,
    SpherePrimitive,
    Timestamp,
    TriangleListPrimitive,
    Vector3,
)

from farhand.common.geometry import Array
from farhand.common.messages import base
from farhand.common.shapes.box import Box
from farhand.common.shapes.capsule import Capsule
from farhand.common.shapes.mesh import Mesh
from farhand.common.shapes.pose import out_of, rotation
from farhand.common.shapes.shape import Shape
from farhand.common.shapes.sphere import Sphere

PLANE_SIZE, PLANE_THICKNESS = 3.0, 0.004
"""m: as much of a half-space as is drawn."""
NANOSECONDS = 1_000_000_000
UPRIGHT: base.Quaternion = (1.0, 0.0, 0.0, 0.0)
BASE, TOOL, PREDICTED = "base", "tool", "predicted"
"""Frames that every robot has: base's, the tool's, and the tool's where the operator's side predicts it."""


class Place(NamedTuple):
    """Where something is.

    Attributes:
        position: (m).
        orientation: unit quaternion (w, x, y, z).
        frame: in which.
    """

    position: base.Vector3
    orientation: base.Quaternion = UPRIGHT
    frame: str = BASE

    @property
    def pose(self) -> Pose:
        """In its frame."""
        return pose(self.position, self.orientation)


def stamp(time_ns: int) -> Timestamp:
    """An instant of the file's time."""
    return Timestamp(sec=time_ns // NANOSECONDS, nsec=time_ns % NANOSECONDS)


def short(value: float) -> float:
    """To 24 bits: the rest of a double is noise that does not compress."""
    return float(np.float32(value))


def vector(v: base.Vector3) -> Vector3:
    """A vector (m)."""
    return Vector3(x=short(v[0]), y=short(v[1]), z=short(v[2]))


def pose(position: base.Vector3, orientation: base.Quaternion = UPRIGHT) -> Pose:
    """A place, from a quaternion (w, x, y, z)."""
    w, x, y, z = map(short, orientation)
    return Pose(position=vector(position), orientation=Quaternion(x=x, y=y, z=z, w=w))


def entity(
    name: str,
    time_ns: int,
    shape: Shape,
    place: Place,
    color: Color,
    *,
    grown: float = 0.0,
    told: Iterable[tuple[str, str]] = (),
) -> SceneEntity:
    """A shape at its place.

    Args:
        name: id of the entity, which replaces the one before.
        time_ns: of the file.
        shape: what.
        place: where.
        color: with its opacity.
        grown: what is added to it all around (m).
        told: what a viewer shows when somebody asks what it is.
    """
    spheres: list[SpherePrimitive] = []
    cubes: list[CubePrimitive] = []
    cylinders: list[CylinderPrimitive] = []
    triangles: list[TriangleListPrimitive] = []
    if isinstance(shape, Sphere):
        spheres.append(_ball(place.position, shape.radius + grown, color))
    elif isinstance(shape, Capsule):
        spheres, cylinders = capsule(shape.half_length, shape.radius + grown, place, color)
    elif isinstance(shape, Box):
        size = vector(tuple(2.0 * (half + grown) for half in shape.half_extents))  # type: ignore[arg-type]
        cubes.append(CubePrimitive(pose=place.pose, size=size, color=color))
    elif isinstance(shape, Mesh):
        triangles.append(_hull(shape, place, color))
    else:
        below = out_of(rotation(place.orientation), place.position, (0.0, 0.0, grown - PLANE_THICKNESS / 2.0))
        size = Vector3(x=PLANE_SIZE, y=PLANE_SIZE, z=PLANE_THICKNESS)
        cubes.append(CubePrimitive(pose=pose(below, place.orientation), size=size, color=color))
    return SceneEntity(
        timestamp=stamp(time_ns),
        frame_id=place.frame,
        id=name,
        frame_locked=True,
        metadata=[KeyValuePair(key=key, value=value) for key, value in told],
        spheres=spheres,
        cubes=cubes,
        cylinders=cylinders,
        triangles=triangles,
    )


def capsule(
    half_length: float, radius: float, place: Place, color: Color
) -> tuple[list[SpherePrimitive], list[CylinderPrimitive]]:
    """A capsule along the z axis of its place, as two balls and a cylinder."""
    rows = rotation(place.orientation)
    ends = [out_of(rows, place.position, (0.0, 0.0, sign * half_length)) for sign in (-1.0, 1.0)]
    size = Vector3(x=short(2.0 * radius), y=short(2.0 * radius), z=short(2.0 * half_length))
    tube = CylinderPrimitive(pose=place.pose, size=size, bottom_scale=1.0, top_scale=1.0, color=color)
    return [_ball(end, radius, color) for end in ends], [tube]


def along(a: Array, b: Array) -> tuple[float, Place]:
    """Half the length of the segment from a to b (m), and the place whose z axis lies along it."""
    middle, way = (a + b) / 2.0, b - a
    length = float(np.linalg.norm(way))
    at: base.Vector3 = (float(middle[0]), float(middle[1]), float(middle[2]))
    if length < 1e-9:
        return 0.0, Place(at)
    x, y, z = (float(value) / length for value in way)
    if z < -1.0 + 1e-9:
        return length / 2.0, Place(at, (0.0, 1.0, 0.0, 0.0))
    half = math.sqrt((1.0 + z) / 2.0)  # the shortest turn of z onto the way
    return length / 2.0, Place(at, (half, -y / (2.0 * half), x / (2.0 * half), 0.0))


def _ball(center: base.Vector3, radius: float, color: Color) -> SpherePrimitive:
    size = short(2.0 * radius)
    return SpherePrimitive(pose=pose(center), size=Vector3(x=size, y=size, z=size), color=color)


def _hull(mesh: Mesh, place: Place, color: Color) -> TriangleListPrimitive:
    return TriangleListPrimitive(pose=place.pose, points=_corners(mesh.vertices), color=color)


@lru_cache(maxsize=64)
def _corners(vertices: tuple[base.Vector3, ...]) -> list[Point3]:
    """Three a face of the hull."""
    return [
        Point3(x=short(x), y=short(y), z=short(z)) for x, y, z in Mesh(vertices).hull.corners.reshape(-1, 3)
    ]
