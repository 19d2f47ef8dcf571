"""Meshes from files: the corners of what is convex; one line for what is not."""

import struct

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from farhand.common.errors import InputError
from farhand.common.shapes.mesh import Mesh
from farhand.common.shapes.mesh_file import MAX_BYTES, read_mesh

CORNERS = np.array([[x, y, z] for x in (0.0, 0.1) for y in (0.0, 0.2) for z in (-0.1, 0.2)])
FACES = ConvexHull(CORNERS).simplices


def binary(triangles, head=b"solid of a kind"):
    rows = b"".join(struct.pack("<12fH", *([0.0] * 3), *np.ravel(t), 0) for t in triangles)
    return head.ljust(80) + struct.pack("<I", len(triangles)) + rows


def ascii_stl(triangles):
    facets = "".join(
        "facet normal 0 0 0\nouter loop\n"
        + "".join(f"vertex {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in t)
        + "endloop\nendfacet\n"
        for t in triangles
    )
    return f"solid part\n{facets}endsolid part\n".encode()


def obj(points, faces, form="{0}"):
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in points]
    lines += ["f " + " ".join(form.format(k + 1) for k in face) for face in faces]
    return "\n".join(["# a part", *lines]).encode()


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("part.stl", binary(CORNERS[FACES])),
        ("PART.STL", ascii_stl(CORNERS[FACES])),
        ("part.obj", obj(CORNERS, FACES)),
        ("slashes.obj", obj(CORNERS, FACES, "{0}/1/1")),
        ("normals.obj", obj(CORNERS, FACES, "{0}//1")),
        ("four.obj", obj(CORNERS, [(0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4)])),
    ],
)
def test_all_forms_give_the_same_corners(tmp_path, name, content):
    (tmp_path / name).write_bytes(content)
    found = np.array(sorted(read_mesh(tmp_path / name)))
    assert found == pytest.approx(np.array(sorted(map(tuple, CORNERS))), abs=1e-7)
    assert Mesh(read_mesh(tmp_path / name)).distance(0.05, 0.1, 0.5) == pytest.approx(0.3, abs=1e-6)


def test_corners_counted_from_the_end_and_millimetres(tmp_path):
    path = tmp_path / "part.obj"
    faces = [" ".join(str(k - len(CORNERS)) for k in face) for face in FACES]
    path.write_bytes(obj(1000 * CORNERS, []) + "".join(f"\nf {face}" for face in faces).encode())
    assert np.array(sorted(read_mesh(path, 0.001))) == pytest.approx(np.array(sorted(map(tuple, CORNERS))))


def many_sided(count):
    points = np.random.default_rng(0).normal(size=(count, 3))
    points *= 0.1 / np.linalg.norm(points, axis=1)[:, None]
    return points[ConvexHull(points).simplices]


def dented(depth):
    """The body with the middle of one face pushed in (m)."""
    triangles = CORNERS[FACES]
    a, b, c = triangles[0]
    outwards = ConvexHull(CORNERS).equations[0][:3]
    tip = (a + b + c) / 3 - depth * outwards
    return np.concatenate([triangles[1:], [[a, b, tip], [b, c, tip], [c, a, tip]]])


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("dent.stl", binary(dented(0.02)), "is not convex: a face lies 20 mm inside its hull"),
        ("empty.stl", binary([]), "is empty: there is no face in it"),
        ("empty.obj", b"", "is empty"),
        ("ascii.stl", b"solid x\nendsolid x\n", "is empty"),
        ("points.obj", obj(CORNERS, []), "is empty"),
        ("flat.stl", binary(CORNERS[FACES] * [1, 1, 0]), "spans no volume"),
        ("thin.stl", binary(CORNERS[FACES] * [1, 1, 1e-4]), "spans no volume: it is 3e-05 m thin"),
        ("huge.stl", binary(1000 * CORNERS[FACES]), "reaches 300 m from its origin, at most 10 m"),
        ("huge.stl", binary(1000 * CORNERS[FACES]), "one in millimetres needs scale = 0.001"),
        ("round.stl", binary(many_sided(400)), "has 400 corners, at most 256"),
        ("cut.stl", binary(CORNERS[FACES])[:-7], "is no STL file, or is cut off"),
        ("cut.obj", obj(CORNERS, FACES)[:40] + b"\nf 1 2 99", "is no OBJ file, or is cut off"),
        ("zero.obj", obj(CORNERS, [(-1, 1, 2)]), "is no OBJ file"),
        ("nan.stl", binary(CORNERS[FACES] * np.nan), "numbers that are not finite"),
        ("big.stl", b"x" * (MAX_BYTES + 1), "is larger than 16 MB"),
        ("part.ply", b"ply", "is neither .stl nor .obj"),
    ],
)
def test_what_will_not_do_is_one_line(tmp_path, name, content, said):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError) as found:
        read_mesh(tmp_path / name)
    assert said in str(found.value)
    assert "\n" not in str(found.value)


def test_a_dent_that_nobody_sees_is_none(tmp_path):
    (tmp_path / "part.stl").write_bytes(binary(dented(0.0005)))
    assert len(read_mesh(tmp_path / "part.stl")) == 8


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(InputError, match="cannot be read: No such file"):
        read_mesh(tmp_path / "part.stl")
