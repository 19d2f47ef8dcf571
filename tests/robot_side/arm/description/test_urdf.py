"""URDFs: what is read of them, and what is refused in one line."""

import numpy as np
import pinocchio as pin
import pytest

from farhand.common.errors import InputError
from farhand.robot_side.arm.description.urdf import read_urdf, tool_frame_of
from farhand.robot_side.arm.description.xml import rotation_rpy, rpy_of_axis
from tests.robot_side.arm.own_arm import urdf


def written(tmp_path, changes=()):
    path = tmp_path / "mine.urdf"
    path.write_text(urdf(changes))
    return path


def test_a_chain_with_a_gripper_beside_it(tmp_path):
    chain = read_urdf(written(tmp_path), "hand")
    assert chain.joint_names == tuple(f"j{i}" for i in range(1, 7))
    assert chain.max_torque.tolist() == [80.0] * 6
    assert chain.standing == {"base"}
    assert frozenset(("link6", "finger")) in chain.adjacent  # the fixed gripper is part of the last link
    assert frozenset(("link5", "hand")) in chain.adjacent
    assert frozenset(("link4", "hand")) not in chain.adjacent
    assert pin.buildModelFromXML(chain.text).nq == 6


@pytest.mark.parametrize(
    ("changes", "frame", "said"),
    [
        ([("<limit[^>]*/>", "")], "hand", "joint 'j1': has no limit: lower, upper, velocity, effort"),
        ([('velocity="2"', "")], "hand", "joint 'j1': has no limit: velocity"),
        ([('velocity="2"', 'velocity="0"')], "hand", "joint 'j1': limits must have lower < upper"),
        ([('lower="-2.9"', 'lower="3"')], "hand", "joint 'j1': limits must have lower < upper"),
        ([('lower="-2.9"', 'lower="nan"')], "hand", "joint 'j1': <limit>: lower='nan': expected 1 finite"),
        ([('type="revolute"', 'type="continuous"')], "hand", "joint 'j1': turns without limits"),
        ([('type="revolute"', 'type="prismatic"')], "hand", "joint 'j1': is prismatic; the chain"),
        ([("<limit", '<mimic joint="j2"/><limit')], "hand", "joint 'j1': mimics another"),
        ([('joint name="j2"', f'joint name="{"j" * 65}"')], "hand", "name 'jjjj"),
        ([], "hnad", "tool frame 'hnad': no such link; nearest are hand"),
        ([], "link3", "3 revolute joints lead to 'link3'; 6 or 7 are needed"),
        ([], "finger", "joint 'grip': is prismatic"),
        ([('parent link="base"', 'parent link="floor"')], "hand", "joint 'j1': its link 'floor' is not there"),
        ([('parent link="base"', 'parent link="link6"')], "hand", "the joints form a circle"),
        ([("<sphere[^>]*/>", '<mesh filename="b.stl"/>')], "hand", "link 'hand': mesh b.stl: no such file"),
        ([("<sphere[^>]*/>", '<mesh filename="package://a/b.stl"/>')], "hand", "link 'hand': mesh package://a/b.stl"),
        ([("<link", '<link name="stray"/><link')], "hand", "link 'base': no joint holds it"),
        ([("<link", '<link name="hand"/><link')], "hand", "link 'hand': is there twice"),
        ([('name="j2"', 'name="j1"')], "hand", "joint 'j1': is there twice"),
        ([('name="j2"', "")], "hand", "joint '': has no name"),
        ([('child link="link2"', 'child link="link3"')], "hand", "joint 'j3': its link 'link3' hangs on another"),
        ([('axis xyz="0 0 1"', 'axis xyz="0 0 0"')], "hand", "joint 'j1': <axis>: xyz='0 0 0': has no direction"),
        ([('xyz="0 0 0.1"', 'xyz="0 0 q"')], "hand", "joint 'j1': <origin>: xyz='0 0 q': expected 3 finite numbers"),
        ([('mass value="1"', 'mass value="x"')], "hand", "link 'base': <mass>: value='x': expected 1 finite number"),
        ([('radius="0.04"', 'radius="0"')], "hand", "link 'link1': <cylinder>: radius='0': must be above 0"),
        ([("</robot>", "<xacro/></robot>")], "hand", "is xacro; expand it first"),
        ([("<robot", "<sdf"), ("</robot", "</sdf")], "hand", "is no URDF: its root is <sdf>"),
        ([("</robot>", "")], "hand", "is not valid XML"),
    ],
)  # fmt: skip
def test_what_cannot_be_used_is_said_in_one_line(tmp_path, changes, frame, said):
    path = written(tmp_path, changes)
    with pytest.raises(InputError) as refused:
        read_urdf(path, frame)
    assert f"URDF {path}: {said}" in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_missing_file(tmp_path):
    with pytest.raises(InputError, match=r"gone.urdf: cannot be read: No such file"):
        read_urdf(tmp_path / "gone.urdf", "hand")


@pytest.mark.parametrize("name", ["meshes/hand.stl", "package://mine/meshes/hand.stl"])
def test_meshes_are_found_beside_the_file_and_in_packages_above_it(tmp_path, name):
    package = tmp_path / "mine"
    (package / "urdf").mkdir(parents=True)
    place = package / ("meshes" if "package" in name else "urdf/meshes")
    place.mkdir()
    (place / "hand.stl").write_text("solid\nendsolid\n")
    path = package / "urdf" / "mine.urdf"
    path.write_text(urdf([("<sphere[^>]*/>", f'<mesh filename="{name}"/>')]))
    assert str(place / "hand.stl") in read_urdf(path, "hand").text


def test_the_only_end_is_the_tools_frame(tmp_path):
    assert tool_frame_of(written(tmp_path)) == "finger"
    with pytest.raises(InputError, match=r"no tool frame: .* such as hand, finger"):
        tool_frame_of(written(tmp_path, [('parent link="hand"', 'parent link="link6"')]))


def test_roll_pitch_yaw_turn_the_z_axis():
    for axis in [*np.eye(3).tolist(), [0.6, 0.0, -0.8], [-0.48, 0.6, 0.64]]:
        assert rotation_rpy(rpy_of_axis(np.array(axis)))[:, 2] == pytest.approx(axis)
    assert rotation_rpy(np.array([0.3, -0.4, 2.0])) == pytest.approx(pin.rpy.rpyToMatrix(0.3, -0.4, 2.0))
