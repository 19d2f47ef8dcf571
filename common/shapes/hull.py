"""The convex hull of some points as its faces, and exact distances to it."""

import math
from dataclasses import dataclass

import numpy as np

from farhand.common.geometry import Array

MIN_THICKNESS = 1e-4
"""Thinner hulls are refused: their faces' normals would be noise (m)."""


class NoHullError(ValueError):
    """Points that span no volume."""


@dataclass(frozen=True, slots=True, eq=False)
class Hull:
    """Faces and edges of a convex body; faces that lie in one plane are given as triangles.

    Attributes:
        normals: (F, 3) of the faces, outwards.
        offsets: (F,): a point p is inside where normals @ p + offsets <= 0 (m).
        corners: (F, 3, 3) of the triangles.
        side_normals, side_offsets: (3 F, 3), (3 F,): a point is above a triangle where the same holds for its sides.
        starts, directions, lengths: (E, 3), (E, 3), (E,) of the edges.
        used: indices of the points that are corners of the hull.
    """

    normals: Array
    offsets: Array
    corners: Array
    side_normals: Array
    side_offsets: Array
    starts: Array
    directions: Array
    lengths: Array
    used: tuple[int, ...]

    def distance(self, x: float, y: float, z: float) -> float:
        """From the surface to a point, negative inside (m)."""
        point = np.array((x, y, z))
        heights = self.normals @ point + self.offsets
        deepest = float(heights.max())
        if deepest <= 0.0:
            return deepest
        face = self._face_below(point, heights)
        if face >= 0:
            return float(heights[face])
        away = self._from_edges(point)
        return math.sqrt(float(np.einsum("ij,ij->i", away, away).min()))

    def witness(self, x: float, y: float, z: float) -> Array:
        """(3,) the point of the surface that is nearest to a point (m)."""
        point = np.array((x, y, z))
        heights = self.normals @ point + self.offsets
        face = int(heights.argmax())
        if heights[face] > 0.0:
            face = self._face_below(point, heights)
        if face >= 0:
            return np.asarray(point - heights[face] * self.normals[face])
        away = self._from_edges(point)
        return np.asarray(point - away[int(np.einsum("ij,ij->i", away, away).argmin())])

    def _face_below(self, point: Array, heights: Array) -> int:
        """The face that a point outside is right above, -1 where it is above none: then an edge is nearest."""
        sides = (self.side_normals @ point + self.side_offsets).reshape(-1, 3)
        above = (heights > 0.0) & (sides.max(axis=1) <= 0.0)
        face = int(above.argmax())
        return face if above[face] else -1

    def _from_edges(self, point: Array) -> Array:
        """(E, 3) from the nearest point of each edge to a point (m)."""
        away = point - self.starts
        along = np.einsum("ij,ij->i", away, self.directions).clip(0.0, self.lengths)
        return np.asarray(away - along[:, None] * self.directions)


def prepare() -> None:
    """Load what hulls are made with, for a program that may be given a mesh while it runs and has no time then."""
    import scipy.spatial  # noqa: F401


def hull_of(points: Array) -> Hull:
    """The hull of (n, 3) points (m); raises NoHullError where they span no volume."""
    from scipy.spatial import ConvexHull, QhullError  # here, as most scenes hold no mesh, and it loads slowly

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
    corners = points[found.simplices]
    starts, ends = corners, np.roll(corners, -1, axis=1)
    outwards = np.cross(ends - starts, normals[:, None])
    middles = corners.mean(axis=1)[:, None]
    outwards *= np.sign(((starts - middles) * outwards).sum(axis=2, keepdims=True))
    pairs = np.unique(
        np.sort(np.stack([found.simplices, np.roll(found.simplices, -1, 1)], 2).reshape(-1, 2)), axis=0
    )
    edges = points[pairs[:, 1]] - points[pairs[:, 0]]
    lengths = np.sqrt((edges**2).sum(axis=1))
    return Hull(
        normals=np.ascontiguousarray(normals),
        offsets=offsets,
        corners=corners,
        side_normals=np.ascontiguousarray(outwards.reshape(-1, 3)),
        side_offsets=-(outwards * starts).sum(axis=2).ravel(),
        starts=points[pairs[:, 0]],
        directions=edges / lengths[:, None],
        lengths=lengths,
        used=used,
    )
