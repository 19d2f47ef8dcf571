"""Convex meshes from files: STL, ascii or binary, and OBJ."""

import struct
from itertools import pairwise
from pathlib import Path

import numpy as np

from farhand.common.errors import InputError
from farhand.common.geometry import Array, Vector3, to_vector3
from farhand.common.shapes.hull import NoHullError, hull_of
from farhand.common.shapes.mesh import MAX_VERTICES

MAX_BYTES = 16_000_000
MAX_REACH = 10.0
"""What reaches farther from its origin is taken to be in other units than metres (m)."""
DENT = 1e-3
"""How deep a face may lie inside the hull of a mesh that counts as convex (m)."""
_HEAD = 80
_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])


def read_mesh(path: Path, scale: float = 1.0) -> tuple[Vector3, ...]:
    """The corners of a convex mesh (m).

    Args:
        path: ends in .stl or .obj.
        scale: what a unit of the file is in m, such as 0.001.

    Raises:
        InputError: it cannot be read, is no mesh, empty, flat, huge, has too many corners, or is not convex; one line
            without the file's name.
    """
    triangles = read_triangles(path) * scale
    if len(triangles) == 0:
        raise InputError("is empty: there is no face in it")
    points = np.unique(triangles.reshape(-1, 3), axis=0)
    if not np.isfinite(points).all():
        raise InputError("holds numbers that are not finite")
    reach = float(np.sqrt((points**2).sum(axis=1).max()))
    if reach > MAX_REACH:
        hint = "; one in millimetres needs scale = 0.001" if scale == 1.0 else ""
        raise InputError(f"reaches {reach:g} m from its origin, at most {MAX_REACH:g} m are possible{hint}")
    try:
        hull = hull_of(points)
    except NoHullError as error:
        raise InputError(str(error).replace("its vertices span", "spans")) from None
    # On a convex body the middle of every face lies on the hull.
    depth = -_deepest(hull.normals, hull.offsets, triangles)
    if depth > DENT:
        raise InputError(
            f"is not convex: a face lies {depth * 1e3:.3g} mm inside its hull; "
            "cut it into convex parts, an obstacle each"
        )
    if len(hull.used) > MAX_VERTICES:
        raise InputError(f"has {len(hull.used)} corners, at most {MAX_VERTICES} are possible; simplify it")
    return tuple(to_vector3(points[index]) for index in hull.used)


def _deepest(normals: Array, offsets: Array, triangles: Array) -> float:
    """Of the middles and corners of all faces, the lowest height over the hull's surface; negative inside (m)."""
    places = np.vstack([triangles.mean(axis=1), triangles.reshape(-1, 3)])
    lowest = 0.0
    for some in np.array_split(places, 1 + len(places) // 4096):
        lowest = min(lowest, float((some @ normals.T + offsets).max(axis=1).min()))
    return lowest


def read_triangles(path: Path) -> Array:
    """(n, 3, 3) corners of the triangles, in the file's units."""
    try:
        with path.open("rb") as file:
            data = file.read(MAX_BYTES + 1)
    except (OSError, ValueError) as error:
        why = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise InputError(f"cannot be read: {why}") from None
    if len(data) > MAX_BYTES:
        raise InputError(f"is larger than {MAX_BYTES // 1_000_000} MB")
    kind = path.suffix.lower()
    if kind not in (".stl", ".obj"):
        raise InputError("is neither .stl nor .obj")
    try:
        if kind == ".obj":
            return _obj(data.decode("utf-8", "replace"))
        return _binary_stl(data) if _is_binary_stl(data) else _ascii_stl(data.decode("ascii", "replace"))
    except (ValueError, IndexError):
        raise InputError(f"is no {kind[1:].upper()} file, or is cut off") from None


def _is_binary_stl(data: bytes) -> bool:
    """By its length, for files of either form may begin with `solid`."""
    if len(data) < _HEAD + 4:
        return False
    (count,) = struct.unpack_from("<I", data, _HEAD)
    return len(data) == _HEAD + 4 + int(count) * _TRIANGLE.itemsize


def _binary_stl(data: bytes) -> Array:
    return np.frombuffer(data, _TRIANGLE, offset=_HEAD + 4)["corners"].astype(float)


def _ascii_stl(text: str) -> Array:
    words = text.split()
    if not words or words[0] != "solid" or "endsolid" not in words:
        raise ValueError
    corners = [words[k + 1 : k + 4] for k, word in enumerate(words) if word == "vertex"]
    return np.array(corners, dtype=float).reshape(-1, 3, 3)


def _obj(text: str) -> Array:
    points: list[list[float]] = []
    triangles: list[list[list[float]]] = []
    for line in text.splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            points.append([float(word) for word in words[1:4]])
        elif words[:1] == ["f"]:
            corners = [_corner(word, points) for word in words[1:]]
            triangles += [[corners[0], a, b] for a, b in pairwise(corners[1:])]
    return np.array(triangles, dtype=float).reshape(-1, 3, 3)


def _corner(word: str, points: list[list[float]]) -> list[float]:
    """The point that `7`, `7/1`, `7//2` or, counted from the end, `-1` names."""
    index = int(word.split("/")[0])
    if index == 0:
        raise ValueError
    return points[index - 1 if index > 0 else index]
