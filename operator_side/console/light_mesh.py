"""Meshes as pages get them: as fine as a page can draw, so that they pack to less."""

import numpy as np
from numpy.typing import NDArray

HEADER = 84
STEPS = 8192
"""The smallest power of two in so many parts of the largest extent is kept of a coordinate: 0.1 mm of a metre."""
NORMAL = 128
"""Of a normal's unit length."""
TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", 9), ("attribute", "<u2")])


def lightened(stl: bytes) -> bytes:
    """The same triangles with rounded numbers; what is no binary STL as it is."""
    count = int.from_bytes(stl[80:HEADER], "little")
    if len(stl) != HEADER + count * TRIANGLE.itemsize or count == 0:
        return stl
    triangles = np.frombuffer(stl, TRIANGLE, offset=HEADER).copy()
    corners = triangles["corners"].reshape(-1, 3)
    if not np.isfinite(corners).all():
        return stl
    extent = float(np.ptp(corners, axis=0).max())
    if extent == 0.0:
        return stl
    triangles["corners"] = _rounded(triangles["corners"], 2.0 ** np.floor(np.log2(extent / STEPS)))
    triangles["normal"] = _rounded(triangles["normal"], 1.0 / NORMAL)
    return stl[:HEADER] + triangles.tobytes()


def _rounded(values: NDArray[np.float32], step: float) -> NDArray[np.float32]:
    return np.asarray(np.round(values / step) * step + 0.0, dtype=np.float32)
