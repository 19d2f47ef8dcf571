"""True distances of an arm's meshes to obstacles, by Coal with the meshes' hulls, and to each other, by their
triangles: none of it is code of the guard."""

from collections.abc import Sequence
from itertools import combinations
from typing import NamedTuple

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
    """An arm's collision meshes, and their hulls.

    Args:
        arm: names the files.
    """

    def __init__(self, arm: ArmModel) -> None:
        self._model = pin.buildModelFromXML(arm.urdf)
        self._data = self._model.createData()
        self._geometry = pin.buildGeomFromUrdfString(self._model, arm.urdf, pin.GeometryType.COLLISION)
        self._triangles: list[object] = [each.geometry for each in self._geometry.geometryObjects]
        for each in self._geometry.geometryObjects:
            if isinstance(each.geometry, coal.BVHModelBase):
                each.geometry.buildConvexHull(True, "Qt")
                each.geometry = each.geometry.convex
        self._hulls: list[object] = [each.geometry for each in self._geometry.geometryObjects]
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

    def between(self, one: str, other: str, below: float = -1e6) -> float:
        """Of two links where the arm was placed (m); 0, or below it, where they meet.

        Of their hulls where these are `below` (m) apart or farther, else of their triangles.
        """
        apart = self._between(self._hulls, one, other)
        return apart if apart >= below else self._between(self._triangles, one, other)

    def _between(self, solids: list[object], one: str, other: str) -> float:
        least = 1e6
        for i in self._of_link.get(one, ()):
            for j in self._of_link.get(other, ()):
                a, b = self._placed.oMg[i], self._placed.oMg[j]
                result = coal.DistanceResult()
                coal.distance(
                    solids[i],
                    coal.Transform3s(a.rotation, a.translation),
                    solids[j],
                    coal.Transform3s(b.rotation, b.translation),
                    self._request,
                    result,
                )
                least = min(least, float(result.min_distance))
        return least

    def pairs(self, home: Array, touching: float) -> list["Pair"]:
        """All pairs of links that move against each other, but for neighbours nearer than `touching` (m) at home.

        Which of them the arm's own description calls harmless is nothing to this.
        """
        self.place(home)
        found = []
        for one, other in combinations(self._of_link, 2):
            first, last = sorted((one, other), key=self._joint)
            beyond = range(self._joint(first), self._joint(last))
            if len(beyond) > 1 or (beyond and self.between(one, other, 1e6) >= touching):
                found.append(Pair(first, last, np.array([self._reach(last, k) for k in beyond]), beyond))
        return found

    def _joint(self, link: str) -> int:
        """Number of joints between the base and a link."""
        return int(self._geometry.geometryObjects[self._of_link[link][0]].parentJoint)

    def _reach(self, link: str, joint: int) -> float:
        """No point of a link is farther from where joint number `joint` turns (m)."""
        own = max(self._size(index) for index in self._of_link[link])
        between = range(joint + 2, self._joint(link) + 1)
        return own + sum(float(np.linalg.norm(self._model.jointPlacements[k].translation)) for k in between)

    def _size(self, index: int) -> float:
        each = self._geometry.geometryObjects[index]
        each.geometry.computeLocalAABB()
        center = np.asarray(each.placement.act(np.asarray(each.geometry.aabb_center).ravel()))
        return float(np.linalg.norm(center)) + float(each.geometry.aabb_radius)


class Pair(NamedTuple):
    """Two links.

    Attributes:
        one, other: the links, the one nearer to the base first.
        reach: (k,) of the second from each of the joints between the two (m).
        joints: their indices.
    """

    one: str
    other: str
    reach: Array
    joints: range


class Pairs:
    """By how much less pairs of links can be apart than when they were measured last.

    Args:
        pairs: which.
        n: the arm's joints.
    """

    def __init__(self, pairs: Sequence[Pair], n: int) -> None:
        self._pairs = tuple(pairs)
        self._reach = np.zeros((len(pairs), n))
        for row, pair in zip(self._reach, pairs, strict=True):
            row[pair.joints.start : pair.joints.stop] = pair.reach
        self._q, self._distance = np.zeros((len(pairs), n)), np.full(len(pairs), -1e6)

    def __getitem__(self, index: int) -> Pair:
        return self._pairs[index]

    def nearer_than(self, distance: float, q: Array) -> list[int]:
        """Which may be nearer than a distance (m) at joint positions q (n,), rad."""
        at_least = self._distance - np.einsum("pn,pn->p", self._reach, np.abs(q - self._q))
        return [int(k) for k in np.flatnonzero(at_least < distance)]

    def measured(self, index: int, q: Array, distance: float) -> None:
        """Note a pair's distance (m) at q."""
        self._q[index], self._distance[index] = q, distance


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
