"""True distances of an arm's meshes to obstacles, by Coal with the meshes' hulls: none of it is code of the guard."""

import coal
import numpy as np
import pinocchio as pin

from farhand.common.geometry import Array
from farhand.common.shapes.box import Box
from farhand.common.shapes.capsule import Capsule
from farhand.common.shapes.mesh import Mesh
from farhand.common.shapes.obstacle import Obstacle
from farhand.common.shapes.plane import Plane
from farhand.common.shapes.pose import rotation
from farhand.common.shapes.shape import Shape
from farhand.common.shapes.sphere import Sphere
from farhand.robot_side.arm.model import ArmModel


class Meshes:
    """The hulls of an arm's collision meshes.

    Args:
        arm: names the files.
    """

    def __init__(self, arm: ArmModel) -> None:
        self._model = pin.buildModelFromXML(arm.urdf)
        self._data = self._model.createData()
        self._geometry = pin.buildGeomFromUrdfString(self._model, arm.urdf, pin.GeometryType.COLLISION)
        for each in self._geometry.geometryObjects:
            if isinstance(each.geometry, coal.BVHModelBase):
                each.geometry.buildConvexHull(True, "Qt")
                each.geometry = each.geometry.convex
        self._placed = self._geometry.createData()
        self._of_link: dict[str, list[int]] = {}
        for index, each in enumerate(self._geometry.geometryObjects):
            link = self._model.frames[each.parentFrame].name
            self._of_link.setdefault(link, []).append(index)
        self._request = coal.DistanceRequest()

    def place(self, q: Array) -> None:
        """Put the arm at joint positions q (n,), rad."""
        pin.updateGeometryPlacements(self._model, self._data, self._geometry, self._placed, q)

    def distance(self, link: str, obstacle: Obstacle) -> float:
        """Of a link to an obstacle where the arm was placed (m); 1e6 of a link without a mesh."""
        least = 1e6
        shape, where = solid(obstacle.shape), pose(obstacle)
        for index in self._of_link.get(link, ()):
            mesh, at = self._geometry.geometryObjects[index].geometry, self._placed.oMg[index]
            result = coal.DistanceResult()
            coal.distance(
                mesh, coal.Transform3s(at.rotation, at.translation), shape, where, self._request, result
            )
            least = min(least, float(result.min_distance))
        return least

    def between(self, one: str, other: str) -> float:
        """Of two links where the arm was placed (m)."""
        least = 1e6
        for i in self._of_link.get(one, ()):
            for j in self._of_link.get(other, ()):
                a, b = self._placed.oMg[i], self._placed.oMg[j]
                result = coal.DistanceResult()
                coal.distance(
                    self._geometry.geometryObjects[i].geometry,
                    coal.Transform3s(a.rotation, a.translation),
                    self._geometry.geometryObjects[j].geometry,
                    coal.Transform3s(b.rotation, b.translation),
                    self._request,
                    result,
                )
                least = min(least, float(result.min_distance))
        return least


def pose(obstacle: Obstacle) -> coal.Transform3s:
    """Where an obstacle is, for Coal."""
    return coal.Transform3s(np.array(rotation(obstacle.orientation)), np.array(obstacle.position))


_SOLIDS: dict[Shape, object] = {}


def solid(shape: Shape) -> object:
    """A shape for Coal."""
    found = _SOLIDS.get(shape)
    if found is None:
        found = _SOLIDS[shape] = _made(shape)
    return found


def _made(shape: Shape) -> object:
    if isinstance(shape, Sphere):
        return coal.Sphere(shape.radius)
    if isinstance(shape, Capsule):
        return coal.Capsule(shape.radius, 2.0 * shape.half_length)
    if isinstance(shape, Box):
        return coal.Box(*(2.0 * half for half in shape.half_extents))
    if isinstance(shape, Plane):
        return coal.Halfspace(np.array([0.0, 0.0, 1.0]), 0.0)
    assert isinstance(shape, Mesh)
    body = coal.BVHModelOBBRSS()
    body.beginModel(len(shape.points), len(shape.points))
    body.addVertices(shape.points)
    body.endModel()
    body.buildConvexHull(True, "Qt")
    return body.convex
