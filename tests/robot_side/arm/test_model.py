"""The arm as arrays against Pinocchio, and as data against the files that it comes from."""

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from farhand.common.errors import InputError
from farhand.robot_side.arm.capsules import segment_distance
from farhand.robot_side.arm.catalogue import ARMS
from farhand.robot_side.arm.kinematics import Kinematics
from farhand.robot_side.arm.model import model

NAMES = tuple(ARMS)


@pytest.fixture(scope="module", params=NAMES)
def arm(request):
    return model(request.param)


@settings(max_examples=60, deadline=None)
@given(name=st.sampled_from(NAMES), shares=st.lists(st.floats(0, 1), min_size=7, max_size=7))
def test_the_arrays_are_pinocchios_kinematics(name, shares):
    arm = model(name)
    q = arm.lower + np.array(shares[: arm.n]) * (arm.upper - arm.lower)
    pinocchio = pin.buildModelFromXML(arm.urdf)
    data = pinocchio.createData()
    pin.framesForwardKinematics(pinocchio, data, q)
    rotations, origins = arm.poses(q)
    for index, joint in enumerate(arm.joint_names):
        pose = data.oMi[pinocchio.getJointId(joint)]
        assert np.abs(rotations[index] - pose.rotation).max() < 1e-9
        assert np.abs(origins[index] - pose.translation).max() < 1e-9
    R, p = arm.tool_pose(q)
    tool = data.oMf[pinocchio.getFrameId(arm.tool_frame)]
    assert np.abs(R - tool.rotation).max() < 1e-9
    assert np.abs(p - tool.translation).max() < 1e-9
    segments = arm.segments(q)
    for (a, _), capsule in zip(segments, arm.capsules, strict=True):
        frame = data.oMf[pinocchio.getBodyId(capsule.part)]
        joint = data.oMi[capsule.joint + 1]
        assert np.abs(a - joint.act(capsule.a)).max() < 1e-9
        assert pinocchio.frames[pinocchio.getBodyId(capsule.part)].parentJoint == capsule.joint + 1
        assert np.linalg.norm(frame.translation - a) < arm.longest_reach


def test_shapes_and_limits(arm):
    n = arm.n
    assert n == (7 if arm.name == "panda" else 6)
    for values in (arm.home, arm.lower, arm.upper, arm.max_velocity, arm.max_acceleration, arm.max_torque):
        assert values.shape == (n,)
    assert arm.R_parent_joint.shape == (n, 3, 3)
    assert arm.p_parent_joint.shape == arm.axes.shape == (n, 3)
    assert np.all((arm.lower < arm.home) & (arm.home < arm.upper))
    assert np.linalg.norm(arm.axes, axis=1) == pytest.approx(np.ones(n))


def test_the_tool_points_down_at_home_where_the_catalogue_says(arm):
    goal = {"ur3": (0.27, 0, 0.2), "ur5": (0.45, 0, 0.3), "ur10": (0.7, 0, 0.4), "panda": (0.45, 0, 0.35)}
    R, p = arm.tool_pose(arm.home)
    assert p == pytest.approx(goal[arm.name.removesuffix("e")], abs=2e-4)
    assert R[:, 2] == pytest.approx((0, 0, -1), abs=2e-4)


# d1, a2, a3, d4, d5, d6 as Universal Robots publish them (m)
PUBLISHED = {
    "ur3": (0.1519, -0.24365, -0.21325, 0.11235, 0.08535, 0.0819),
    "ur5": (0.089159, -0.425, -0.39225, 0.10915, 0.09465, 0.0823),
    "ur10": (0.1273, -0.612, -0.5723, 0.163941, 0.1157, 0.0922),
    "ur3e": (0.15185, -0.24355, -0.2132, 0.13105, 0.08535, 0.0921),
    "ur5e": (0.1625, -0.425, -0.3922, 0.1333, 0.0997, 0.0996),
}


def published_pose(name, q):
    """Rotation and position of the flange in the controller's base, by Denavit and Hartenberg."""
    d1, a2, a3, d4, d5, d6 = PUBLISHED[name]
    right = np.pi / 2
    T = np.eye(4)
    for angle, d, a, twist in zip(
        q, (d1, 0, 0, d4, d5, d6), (0, a2, a3, 0, 0, 0), (right, 0, 0, right, -right, 0), strict=True
    ):
        (c, s), (ca, sa) = (np.cos(angle), np.sin(angle)), (np.cos(twist), np.sin(twist))
        T = T @ [[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1]]
    return T[:3, :3], T[:3, 3]


@pytest.mark.parametrize("name", list(PUBLISHED))
def test_a_ur_stands_where_its_maker_says(name):
    arm, rng = model(name), np.random.default_rng(3)
    about = np.diag([-1.0, -1.0, 1.0])  # `base` is `base_link` turned by pi
    for _ in range(20):
        q = rng.uniform(arm.lower, arm.upper)
        R, p = arm.tool_pose(q)
        R_said, p_said = published_pose(name, q)
        assert about @ p_said == pytest.approx(p, abs=2e-4 if name == "ur10" else 1e-4)
        assert about @ R_said == pytest.approx(R, abs=1e-4)


REACHED = {"ur3": (0.2, 0.3, 0.2), "ur10": (0.5, 0.9, 0.4), "panda": (0.35, 0.55, 0.35)}


@pytest.mark.parametrize("name", list(REACHED))
@pytest.mark.parametrize("angle", [-2.5, -1.0, 0.0, 1.3])
def test_inverse_kinematics_reaches_the_roomy_region(name, angle):
    kinematics = Kinematics(model(name))
    near, far, z = REACHED[name]
    for r in (near, far):
        goal = (r * np.cos(angle), r * np.sin(angle), z)
        q = kinematics.inverse_tool_down(goal, None)
        tool = kinematics.tool(q)
        assert np.allclose(tool.position, goal, atol=1e-6)
        assert np.allclose(tool.R_base_tool, kinematics.R_base_tool_down, atol=1e-5)
        assert np.all((kinematics.lower <= q) & (q <= kinematics.upper))


def test_at_home_no_two_parts_are_near_each_other(arm):
    assert arm.self_gaps(arm.home).min() > 0.025
    assert all(arm.capsules[i].joint != arm.capsules[j].joint for i, j in arm.self_pairs)
    parts = {frozenset((arm.capsules[i].part, arm.capsules[j].part)) for i, j in arm.self_pairs}
    assert not parts & arm.never_colliding
    far = {"panda": ("panda_link0", "panda_hand")}.get(arm.name, ("base_link", "wrist_3_link"))
    assert frozenset(far) in parts


def test_physics_gets_no_visuals_and_a_gripper_that_stays(arm):
    assert "<visual" not in arm.urdf
    assert "package://" not in arm.urdf
    assert "prismatic" not in arm.urdf
    assert pin.buildModelFromXML(arm.urdf).nq == arm.n


def test_an_unknown_arm_gets_the_nearest_names():
    with pytest.raises(InputError, match=r"'pandas': no such arm; nearest are panda"):
        model("pandas")


@settings(max_examples=100, deadline=None)
@given(st.lists(st.floats(-1, 1), min_size=12, max_size=12), st.booleans())
def test_distance_of_segments(numbers, parallel):
    a, b, c, d = np.array(numbers).reshape(4, 3)
    if parallel:
        d = c + 0.5 * (b - a)
    found = segment_distance(a, b, c, d)
    shares = np.linspace(0, 1, 41)
    one = a + shares[:, None] * (b - a)
    other = c + shares[:, None] * (d - c)
    sampled = np.linalg.norm(one[:, None] - other[None], axis=2).min()
    step = (np.linalg.norm(b - a) + np.linalg.norm(d - c)) / 80
    assert sampled - step - 1e-9 <= found <= sampled + 1e-9
