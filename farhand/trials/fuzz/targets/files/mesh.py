"""Mesh files: STL, both kinds, and OBJ."""

import struct
from collections.abc import Callable

from farhand.common.errors import InputError
from farhand.common.shapes.mesh_file import read_mesh
from farhand.trials.fuzz.files import scratch
from farhand.trials.fuzz.target import Target, check, one_line

CORNERS = ((0.0, 0.0, 0.0), (0.2, 0.0, 0.0), (0.0, 0.2, 0.0), (0.0, 0.0, 0.2))
FACES = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2))


def seeds() -> list[bytes]:
    """A tetrahedron in each form."""
    obj = "".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS)
    obj += "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in FACES)
    text = "solid x\n"
    binary = b"x" * 80 + struct.pack("<I", len(FACES))
    for face in FACES:
        text += "facet normal 0 0 0\nouter loop\n"
        text += (
            "".join("vertex {} {} {}\n".format(*CORNERS[corner]) for corner in face) + "endloop\nendfacet\n"
        )
        binary += struct.pack("<12fH", 0, 0, 0, *(v for corner in face for v in CORNERS[corner]), 0)
    return [b"\0" + binary, b"\0" + (text + "endsolid x\n").encode(), b"\1" + obj.encode()]


def start() -> Callable[[bytes], None]:
    """See Target."""
    paths = scratch("mesh.stl"), scratch("mesh.obj")

    def take(data: bytes) -> None:
        path = paths[data[0] % 2 if data else 0]
        path.write_bytes(data[1:])
        try:
            corners = read_mesh(path)
        except InputError as error:
            one_line(error)
            return
        check(4 <= len(corners) <= 256, "a mesh of no use")

    return take


TARGET = Target(
    edge="mesh files: STL, OBJ",
    promise="a refusal is one line; what is read is a body",
    seeds=seeds,
    start=start,
    head=1,
)
