"""What a link is made of: balls whose convex hull is the link's collision geometry, in the link's own frame."""

import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path

import coal
import numpy as np
from scipy.spatial import ConvexHull, QhullError

from farhand.common.errors import InputError
from farhand.common.geometry import Array
from farhand.robot_side.arm.description.xml import numbers, rotation_rpy

_SIDES = 32
"""Of the prism that stands for a cylinder, and that lies around it."""


@dataclass(frozen=True, slots=True)
class Body:
    """Balls; a vertex of a mesh or a corner of a box is one without radius.

    Attributes:
        points: (m, 3) centres (m).
        radii: (m,) of the balls (m).
    """

    points: Array
    radii: Array

    def hull(self) -> "Body":
        """The same without the vertices that lie within the hull of the others."""
        sharp = self.radii == 0.0
        points = self.points[sharp]
        if len(points) > 4:
            try:
                points = points[ConvexHull(points).vertices]
            except QhullError:  # flat: every vertex counts
                points = np.unique(points, axis=0)
        radii = np.concatenate([np.zeros(len(points)), self.radii[~sharp]])
        return Body(np.concatenate([points, self.points[~sharp]]), radii)


def bodies(urdf: str) -> dict[str, Body]:
    """Each link's body by the link's name; links without collision geometry are left out.

    Args:
        urdf: text, with meshes by absolute path.

    Raises InputError when a mesh cannot be read.
    """
    found = {}
    for link in ET.fromstring(urdf).findall("link"):
        parts = [_part(collision, link.get("name", "")) for collision in link.findall("collision")]
        if parts:
            points, radii = zip(*parts, strict=True)
            found[link.get("name", "")] = Body(np.concatenate(points), np.concatenate(radii))
    return found


def _part(collision: ET.Element, link: str) -> tuple[Array, Array]:
    points, radii = _shape(collision, link)
    origin = collision.find("origin")
    xyz = numbers(origin, "xyz", (0.0, 0.0, 0.0)) if origin is not None else np.zeros(3)
    rpy = numbers(origin, "rpy", (0.0, 0.0, 0.0)) if origin is not None else np.zeros(3)
    return points @ rotation_rpy(rpy).T + xyz, radii


def _shape(collision: ET.Element, link: str) -> tuple[Array, Array]:
    shape = collision.find("geometry/*")
    if shape is None:
        raise InputError(f"link {link!r}: a collision without geometry")
    if shape.tag == "mesh":
        points = _vertices(Path(shape.get("filename", "")), numbers(shape, "scale", (1.0, 1.0, 1.0)), link)
        return points, np.zeros(len(points))
    if shape.tag == "box":
        corners = np.array(np.meshgrid([-0.5, 0.5], [-0.5, 0.5], [-0.5, 0.5])).reshape(3, -1).T
        return corners * numbers(shape, "size"), np.zeros(8)
    if shape.tag == "sphere":
        return np.zeros((1, 3)), numbers(shape, "radius", size=1)
    if shape.tag in ("cylinder", "capsule"):
        (radius,), (length,) = numbers(shape, "radius", size=1), numbers(shape, "length", size=1)
        ends = np.array([[0.0, 0.0, -length / 2], [0.0, 0.0, length / 2]])
        if shape.tag == "capsule":
            return ends, np.full(2, radius)
        angles = 2.0 * np.pi * np.arange(_SIDES) / _SIDES
        rim = radius / np.cos(np.pi / _SIDES) * np.column_stack([np.cos(angles), np.sin(angles), 0 * angles])
        return np.concatenate([rim + end for end in ends]), np.zeros(2 * _SIDES)
    raise InputError(f"link {link!r}: {shape.tag}: no such collision geometry")


def _vertices(path: Path, scale: Array, link: str) -> Array:
    try:
        vertices: Array = np.array(coal.MeshLoader().load(str(path), scale).vertices())
    except (RuntimeError, ValueError):
        raise InputError(f"mesh {path} of link {link!r}: cannot be read as STL, OBJ or DAE") from None
    if not len(vertices) or not np.isfinite(vertices).all():
        raise InputError(f"mesh {path} of link {link!r}: has no vertices, or one that is not finite")
    return vertices
