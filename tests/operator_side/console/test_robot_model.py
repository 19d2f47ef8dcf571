"""A robot's drawing: light meshes of the package's own folder, and no other file of this host."""

import numpy as np
import pytest

from farhand.common.errors import InputError
from farhand.operator_side.console.light_mesh import HEADER, TRIANGLE, light_mesh
from farhand.operator_side.console.robot_model import RobotModel
from farhand.robot_side.arm.catalogue import ARMS, urdf_of
from farhand.robot_side.arm.description.finding import installed

LINK = """<robot name="r"><link name="a">
<visual><geometry><mesh filename="package://example-robot-data/robots/heavy.dae"/></geometry></visual>
<collision><geometry><mesh filename="package://example-robot-data/robots/{}"/></geometry></collision>
</link><transmission name="t"/></robot>"""


def test_what_is_drawn_is_what_is_used_against_collisions(tmp_path):
    (tmp_path / "light.stl").write_bytes(b"x" * 84)
    (tmp_path / "r.urdf").write_text(LINK.format("light.stl"))
    model = RobotModel(tmp_path, "r.urdf")
    assert b"heavy" not in model.urdf
    assert b'<visual><geometry><mesh filename="0-light.stl"' in model.urdf
    assert model.meshes == {"0-light.stl": tmp_path / "light.stl"}


def test_an_arm_of_another_package_is_drawn_by_its_meshes_as_stl():
    arm = ARMS["ur5e"]
    model = RobotModel(installed(arm.shapes), urdf_of(arm), f"package://{arm.shapes}/")
    assert len(model.meshes) == 7
    assert all(name.endswith(".stl") and name.encode() in model.urdf for name in model.meshes)
    for path in model.meshes.values():
        stl = light_mesh(path)
        triangles = np.frombuffer(stl, TRIANGLE, offset=HEADER)
        assert len(triangles) == int.from_bytes(stl[80:HEADER], "little") > 30
        assert np.abs(triangles["corners"]).max() < 0.6  # m
        assert np.linalg.norm(triangles["normal"], axis=1).max() < 1.02


@pytest.mark.parametrize("mesh", ["../outside.stl", "missing.stl", "r.urdf"])
def test_no_other_file_is_given_away(tmp_path, mesh):
    inside = tmp_path / "robots"
    inside.mkdir()
    (tmp_path / "outside.stl").write_bytes(b"")
    (inside / "r.urdf").write_text(LINK.format(mesh))
    with pytest.raises(InputError, match="no mesh"):
        RobotModel(inside, "r.urdf")


def test_what_is_no_urdf_is_said(tmp_path):
    (tmp_path / "r.urdf").write_text("<robot")
    with pytest.raises(InputError, match="cannot be read"):
        RobotModel(tmp_path, "r.urdf")
