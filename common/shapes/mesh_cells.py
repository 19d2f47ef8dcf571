"""A convex body of many faces cut into pieces of which each fits into one sphere that hardly leaves the body.

As for boxes (`box_cells.py`): a sphere of radius R around a point at depth D leaves the body by R - D at most. A piece
is known by its corners: cutting it by a plane keeps those on either side and adds where lines between them cross it.
"""

import numpy as np

from farhand.common.geometry import Array
from farhand.common.shapes.hull import Hull

_STEPS = 24


def mesh_spheres(points: Array, hull: Hull, excess: float, most: int) -> tuple[Array, Array] | None:
    """Spheres that cover a hull: centres (k, 3) and radii (k,) (m); None where it takes too many.

    Args:
        points: (n, 3) corners of the hull (m).
        hull: its faces.
        excess: by how much a sphere may leave the hull at most (m).
        most: how many spheres at most.
    """
    waiting = [points]
    centres: list[Array] = []
    radii: list[float] = []
    while waiting:
        if len(waiting) + len(radii) > most:
            return None
        piece = waiting.pop()
        centre, radius, leaves = _fit(piece, hull, excess)
        if leaves <= excess:
            centres.append(centre)
            radii.append(radius)
        else:
            waiting.extend(_halved(piece))
    return np.array(centres), np.array(radii)


def _fit(piece: Array, hull: Hull, excess: float) -> tuple[Array, float, float]:
    """The sphere of a piece: centre (3,), radius, and by how much it leaves the hull at most (m).

    R - D is convex in the centre; some steps down its slope, ever shorter, come near its least.
    """
    centre = 0.5 * (piece.min(axis=0) + piece.max(axis=0))
    step = 0.25 * float(np.sqrt(((piece - centre) ** 2).sum(axis=1).max()))
    best, best_radius, least = centre, 0.0, np.inf
    for _ in range(_STEPS):
        away = centre - piece
        squares = (away * away).sum(axis=1)
        farthest = int(squares.argmax())
        radius = float(np.sqrt(squares[farthest]))
        heights = hull.normals @ centre + hull.offsets
        nearest = int(heights.argmax())
        height = float(heights[nearest])
        if height > 0.0:
            height = hull.distance(*centre)
        if radius + height < least:
            best, best_radius, least = centre, radius, radius + height
            if least <= excess:
                break
        slope = away[farthest] / max(radius, 1e-12) + hull.normals[nearest]
        norm = float(np.sqrt(slope @ slope))
        if norm < 1e-9:
            break
        centre = centre - step / norm * slope
        step *= 0.85
    return best, best_radius, least


def _halved(piece: Array) -> list[Array]:
    """Both parts of a piece, cut in the middle across its longest extent."""
    low, high = piece.min(axis=0), piece.max(axis=0)
    axis = int((high - low).argmax())
    middle = 0.5 * (low[axis] + high[axis])
    side = piece[:, axis] - middle
    below, above = piece[side <= 0.0], piece[side >= 0.0]
    share = (side[side < 0.0][:, None] / (side[side < 0.0][:, None] - side[side > 0.0][None]))[..., None]
    one, other = piece[side < 0.0][:, None], piece[side > 0.0][None]
    cut = (one + share * (other - one)).reshape(-1, 3)
    cut[:, axis] = middle
    cut = _corners(cut, [k for k in range(3) if k != axis])
    return [np.vstack([below, cut]), np.vstack([above, cut])]


def _corners(cut: Array, axes: list[int]) -> Array:
    """The corners of a cross-section; all of its points where it has no area."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        return np.asarray(cut[ConvexHull(cut[:, axes]).vertices])
    except (QhullError, ValueError):
        return cut
