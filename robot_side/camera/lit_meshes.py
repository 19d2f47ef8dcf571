"""Meshes with the normals that light needs: those of the UR arms' files are zero, and would be drawn black."""

import re
from pathlib import Path

import numpy as np

_FILE = re.compile(r'filename="([^"]+\.stl)"', re.IGNORECASE)
_HEAD = 84  # bytes of a binary STL before its facets: 80 of text, the count
_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])


def with_lit_meshes(urdf: str, folder: Path) -> str:
    """The same URDF, whose binary STL files are copies in `folder` with normals that follow from the corners."""
    copies: dict[str, str] = {}
    for name in _FILE.findall(urdf):
        if name not in copies:
            copies[name] = _lit(Path(name), folder / f"{len(copies)}.stl")
    return _FILE.sub(lambda found: f'filename="{copies[found[1]]}"', urdf)


def _lit(source: Path, copy: Path) -> str:
    """The copy's name; the source's where it is no binary STL, which then stays as it is."""
    try:
        content = source.read_bytes()
    except OSError:
        return str(source)
    count = int.from_bytes(content[_HEAD - 4 : _HEAD], "little")
    if len(content) != _HEAD + count * _FACET.itemsize:
        return str(source)
    facets = np.frombuffer(content, _FACET, count, _HEAD).copy()
    a, b, c = (facets["corners"][:, corner] for corner in range(3))
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    facets["normal"] = normals / np.where(lengths > 0.0, lengths, 1.0)
    copy.write_bytes(content[:_HEAD] + facets.tobytes())
    return str(copy)
