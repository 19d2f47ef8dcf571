"""The convex hull of some points as its faces, and exact distances to it."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from farhand.common.geometry import Array

MIN_THICKNESS = 1e-4
"""Thinner hulls are refused: their faces' normals would be noise (m)."""


class NoHullError(ValueError):
    """Points that span no volume."""


@dataclass(frozen=True, slots=True, eq=False)
class Hull:
    """Faces of a convex body; faces that lie in one plane are given as triangles.

    Attributes:
        normals: (F, 3) of the faces, outwards.
        offsets: (F,): a point p is inside where normals @ p + offsets <= 0 (m).
        corners: (F, 3, 3) of the triangles.
        used: indices of the points that are corners of the hull.
    """

    normals: Array
    offsets: Array
    corners: Array
    used: tuple[int, ...]

    def distance(self, x: float, y: float, z: float) -> float:
        """From the surface to a point, negative inside (m)."""
        point = np.array((x, y, z))
        heights = self.normals @ point + self.offsets
        deepest = float(heights.max())
        if deepest <= 0.0:
            return deepest
        nearest = self._nearest_outside(point, heights)
        return float(np.sqrt(((point - nearest) ** 2).sum()))

    def witness(self, x: float, y: float, z: float) -> Array:
        """(3,) the point of the surface that is nearest to a point (m)."""
        point = np.array((x, y, z))
        heights = self.normals @ point + self.offsets
        best = int(heights.argmax())
        if heights[best] <= 0.0:
            return np.asarray(point - heights[best] * self.normals[best])
        return self._nearest_outside(point, heights)

    def _nearest_outside(self, point: Array, heights: Array) -> Array:
        """The nearest point lies on a face that the point can see."""
        nearest = nearest_on_triangles(point, self.corners[heights > 0.0])
        squares = ((nearest - point) ** 2).sum(axis=1)
        return np.asarray(nearest[int(squares.argmin())])


def hull_of(points: Array) -> Hull:
    """The hull of (n, 3) points (m); raises NoHullError where they span no volume."""
    try:
        found = ConvexHull(points)
    except (QhullError, ValueError):
        raise NoHullError("its vertices span no volume") from None
    normals, offsets = found.equations[:, :3], found.equations[:, 3]
    # Of every face, how far the hull reaches behind it: the least of these is its thickness.
    depths = -(normals @ points[found.vertices].T + offsets[:, None]).min(axis=1)
    if depths.min() < MIN_THICKNESS:
        raise NoHullError(f"its vertices span no volume: it is {depths.min():.1g} m thin")
    # Qhull's rounding may leave a vertex a hair outside its faces; the faces move out to it.
    offsets = offsets - np.maximum(0.0, (normals @ points.T + offsets[:, None]).max(axis=1))
    used = tuple(sorted(int(index) for index in found.vertices))
    return Hull(np.ascontiguousarray(normals), offsets, points[found.simplices], used)


def nearest_on_triangles(point: Array, corners: Array) -> Array:
    """(n, 3) the nearest point of each of (n, 3, 3) triangles to a point (m).

    By the regions of Ericson, Real-Time Collision Detection, 5.1.5: corner, edge or face.
    """
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    ab, ac, bc = b - a, c - a, c - b
    normal = np.cross(ab, ac)
    square = np.maximum((normal * normal).sum(axis=1), 1e-300)
    v = (np.cross(point - a, ac) * normal).sum(
        axis=1
    ) / square  # barycentric, of the point in the face's plane
    w = (np.cross(ab, point - a) * normal).sum(axis=1) / square
    inside = (v >= 0.0) & (w >= 0.0) & (v + w <= 1.0)
    on_face = a + v[:, None] * ab + w[:, None] * ac
    edges = np.stack([_nearest_on_edges(point, s, e) for s, e in ((a, ab), (a, ac), (b, bc))])
    which = ((edges - point) ** 2).sum(axis=2).argmin(axis=0)
    on_edge = edges[which, np.arange(len(corners))]
    return np.asarray(np.where(inside[:, None], on_face, on_edge))


def _nearest_on_edges(point: Array, start: Array, edge: Array) -> Array:
    squares = np.maximum((edge * edge).sum(axis=1), 1e-300)
    share = np.clip(((point - start) * edge).sum(axis=1) / squares, 0.0, 1.0)
    return np.asarray(start + share[:, None] * edge)
