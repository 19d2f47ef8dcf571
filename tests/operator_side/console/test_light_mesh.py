"""Meshes as pages get them."""

import gzip

import numpy as np
import pytest

from farhand.operator_side.console.light_mesh import HEADER, TRIANGLE, lightened
from farhand.robot_side.arm.catalogue import data_folder


def triangles_of(stl):
    return np.frombuffer(stl, TRIANGLE, offset=HEADER)


def test_a_mesh_packs_to_less_and_is_off_by_less_than_a_tenth_of_a_millimetre():
    path = next(data_folder().glob("ur_description/meshes/ur3/collision/forearm.stl"))
    before = path.read_bytes()
    after = lightened(before)
    assert len(gzip.compress(after)) < 0.7 * len(gzip.compress(before))
    off = np.abs(triangles_of(after)["corners"] - triangles_of(before)["corners"])
    assert off.max() < 1e-4
    turned = np.abs(triangles_of(after)["normal"] - triangles_of(before)["normal"])
    assert turned.max() <= 1 / 128


@pytest.mark.parametrize(
    "stl", [b"", b"solid a\nendsolid a\n", b"x" * 84, b"\0" * 84, b"\0" * 80 + b"\1\0\0\0" + b"\0" * 49]
)
def test_what_is_no_binary_mesh_stays_as_it_is(stl):
    assert lightened(stl) == stl


def test_a_mesh_of_numbers_that_are_none_or_of_one_point_stays_as_it_is():
    for value in (np.nan, np.inf, 1.0):
        one = np.zeros(1, TRIANGLE)
        one["corners"] = value
        stl = b"\0" * 80 + b"\1\0\0\0" + one.tobytes()
        assert lightened(stl) == stl
