"""A box cut into cells of which each fits into one sphere that hardly leaves the box.

A sphere of radius R around a point at depth D below the surface of a convex body leaves the body by R - D at most.
So the sphere that covers a cell lies deeper than the cell's middle where that helps: far below the middle of a
face one large sphere covers much of it, along edges and at corners it takes many small ones.
"""

import numpy as np

from farhand.common.geometry import Array, Vector3

_DEPTHS = 48
_TRIALS = 24


def box_spheres(half: Vector3, excess: float, most: int) -> tuple[Array, Array] | None:
    """Spheres that cover a box: centres (k, 3) in its own frame and radii (k,) (m); None where it takes too many.

    Args:
        half: the box's half extents (m).
        excess: by how much a sphere may leave the box at most (m).
        most: how many spheres at most.
    """
    extents = np.array(half)
    best: tuple[Array, Array] | None = None
    first = 0.0
    for size in np.geomspace(min(float(extents.max()), 4.0 * excess), 0.5 * excess, _TRIALS):
        if size < 0.75 * first:
            break  # smaller cells than the largest that fit at the corners: only the count decides
        counts = np.maximum(1, np.ceil(extents / size - 1e-9))
        found = _spheres_on_lattice(extents, counts.astype(int), excess, most)
        if found is not None:
            first = first or float(size)
            if best is None or len(found[1]) < len(best[1]):
                best = found
    return best


def _spheres_on_lattice(
    extents: Array, counts: Array, excess: float, most: int
) -> tuple[Array, Array] | None:
    """Blocks of lattice cells as large as may be; None where a corner cell does not fit, or they are too many."""
    size = 2.0 * extents / counts
    *_, leaves = _fit(extents, -extents[None], (size - extents)[None])
    if leaves[0] > excess:
        return None
    low, high = np.zeros((1, 3), dtype=int), counts[None].copy()
    centres, radii, number = [], [], 0
    while len(low):
        if number + len(low) > most:
            return None
        middle, radius, leaves = _fit(extents, low * size - extents, high * size - extents)
        fits = leaves <= excess
        number += int(fits.sum())
        centres.append(middle[fits])
        radii.append(radius[fits])
        low, high = _halved(low[~fits], high[~fits], size)
    return np.vstack(centres), np.concatenate(radii)


def _halved(low: Array, high: Array, size: Array) -> tuple[Array, Array]:
    """Every block in two, across its longest side that has more than one cell."""
    cells = high - low
    axis = np.where(cells > 1, cells * size, 0.0).argmax(axis=1)
    each = np.arange(len(low))
    middle = (low[each, axis] + high[each, axis]) // 2
    left, right = high.copy(), low.copy()
    left[each, axis] = right[each, axis] = middle
    return np.vstack([low, right]), np.vstack([left, high])


def _fit(extents: Array, low: Array, high: Array) -> tuple[Array, Array, Array]:
    """For each block (n, 3) to (n, 3) its sphere's centre (n, 3) and radius (n,), and by how much that leaves the
    box (n,) (m)."""
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    own = (extents - np.abs(middle)).min(axis=1)
    share = np.linspace(0.0, 1.0, _DEPTHS)
    depth = own[:, None] + share * (extents.min() - own)[:, None]  # (n, d)
    limit = extents - depth[:, :, None]  # of the centre's coordinates at that depth
    centre = np.clip(middle[:, None], -limit, limit)
    reach = half[:, None] + np.abs(middle[:, None] - centre)
    radius = np.sqrt((reach**2).sum(axis=2))
    each, best = np.arange(len(low)), (radius - depth).argmin(axis=1)
    found = radius[each, best]
    return centre[each, best], found, found - depth[each, best]
