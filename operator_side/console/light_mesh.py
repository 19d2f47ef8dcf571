"""Meshes as pages get them: as fine as a page can draw, so that they pack to less."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from farhand.common.shapes.mesh_file import read_triangles

HEADER = 84
STEPS = 8192
"""The smallest power of two in so many parts of the largest extent is kept of a coordinate: 0.1 mm of a metre."""
NORMAL = 128
"""Of a normal's unit length."""
TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", 9), ("attribute", "<u2")])


def light_mesh(path: Path) -> bytes:
    """A file of STL or OBJ as binary STL, lightened."""
    return lightened(path.read_bytes() if path.suffix.lower() == ".stl" else _stl_of(path))


def _stl_of(path: Path) -> bytes:
    corners = read_triangles(path)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    triangles = np.zeros(len(corners), TRIANGLE)
    triangles["corners"] = corners.reshape(-1, 9)
    triangles["normal"] = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    return bytes(HEADER - 4) + len(corners).to_bytes(4, "little") + triangles.tobytes()


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
