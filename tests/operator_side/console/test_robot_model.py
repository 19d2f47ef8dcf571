"""A robot's drawing: light meshes of the package's own folder, and no other file of this host."""

import pytest

from farhand.common.errors import InputError
from farhand.operator_side.console.robot_model import RobotModel

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
