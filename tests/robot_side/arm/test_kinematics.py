"""PyBullet against Pinocchio, and the inverse kinematics against the forward one."""

import numpy as np
import pinocchio as pin
import pytest

from farhand.common.errors import ScenarioError
from farhand.common.messages.scene import Obstacle
from farhand.common.seeds import stream
from farhand.robot_side.arm.kinematics import Kinematics, rotation_error
from farhand.robot_side.arm.model import model
from farhand.robot_side.robots import pybullet_arm
from farhand.robot_side.robots.pybullet_arm import ArmRobot, ArmWorld
from farhand.robot_side.robots.registry import make_robot
from farhand.runs.scenario import load_scenario, replace_setting

SCENARIO = load_scenario("ur5-obstacle")
UR5 = model("ur5")
GRAVITY = 9.81


@pytest.fixture(scope="module")
def robot():
    with pytest.MonkeyPatch.context() as patch:  # the tool's frame as well, which the physics does without
        patch.setattr(pybullet_arm, "massive_text", lambda text: text)
        robot = ArmRobot(SCENARIO)
    yield robot
    robot.close()


@pytest.fixture(scope="module")
def configurations():
    return stream(1, "configurations").uniform(-2.5, 2.5, (20, 6))


def put(robot, q, qd=None):
    qd = np.zeros(6) if qd is None else qd
    for index, angle, rate in zip(robot.joint_indices, q, qd, strict=True):
        robot._bullet.resetJointState(robot.body, index, angle, rate, physicsClientId=robot._client)


def test_tool_pose_and_jacobian_agree(robot, configurations):
    bullet, client = robot._bullet, robot._client
    tool_link = robot.link_indices["tool0"]
    for q in configurations:
        put(robot, q)
        tool = robot.kinematics.tool(q)
        state = bullet.getLinkState(
            robot.body, tool_link, computeForwardKinematics=True, physicsClientId=client
        )
        assert np.allclose(state[4], tool.position, atol=1e-7)
        R = np.array(bullet.getMatrixFromQuaternion(state[5])).reshape(3, 3)
        assert np.allclose(R, tool.R_base_tool, atol=1e-6)
        zeros = [0.0] * 6
        J = bullet.calculateJacobian(
            robot.body, tool_link, [0.0, 0.0, 0.0], q.tolist(), zeros, zeros, physicsClientId=client
        )
        assert np.allclose(np.vstack(J), tool.jacobian, atol=1e-6)


def test_masses_and_torques_agree(robot, configurations):
    bullet, client, model = robot._bullet, robot._client, robot.kinematics.model
    data = model.createData()
    masses = [
        bullet.getDynamicsInfo(robot.body, index, physicsClientId=client)[0] for index in robot.joint_indices
    ]
    assert np.allclose(masses, [inertia.mass for inertia in list(model.inertias)[1:]], atol=1e-9)
    rng = stream(2, "motions")
    for q in configurations:
        qd, qdd = rng.normal(0, 1, 6), rng.normal(0, 2, 6)
        torques = bullet.calculateInverseDynamics(
            robot.body, q.tolist(), qd.tolist(), qdd.tolist(), physicsClientId=client
        )
        assert np.allclose(torques, pin.rnea(model, data, q, qd, qdd), atol=1e-5)


def test_jacobian_is_the_derivative_of_the_pose(configurations):
    kinematics, h = Kinematics(UR5), 1e-6
    for q in configurations[:5]:
        tool = kinematics.tool(q)
        for joint in range(6):
            step = np.zeros(6)
            step[joint] = h
            after, before = kinematics.tool(q + step), kinematics.tool(q - step)
            linear = (after.position - before.position) / (2 * h)
            angular = rotation_error(after.R_base_tool, before.R_base_tool) / (2 * h)
            assert np.allclose(np.concatenate([linear, angular]), tool.jacobian[:, joint], atol=1e-7)


def test_home_is_where_the_task_says():
    tool = Kinematics(UR5).tool(UR5.home)
    assert np.allclose(tool.position, (0.45, 0.0, 0.30), atol=2e-4)
    assert np.allclose(tool.R_base_tool[:, 2], (0, 0, -1), atol=2e-4)


@pytest.mark.parametrize("r", [0.30, 0.45, 0.65])
@pytest.mark.parametrize("angle", [-2.8, -1.2, 0.0, 1.5, 3.0])
@pytest.mark.parametrize("z", [0.12, 0.35, 0.55])
def test_inverse_kinematics_reaches_the_roomy_region(r, angle, z):
    kinematics = Kinematics(UR5)
    goal = (r * np.cos(angle), r * np.sin(angle), z)
    q = kinematics.inverse_tool_down(goal, None)
    tool = kinematics.tool(q)
    assert np.allclose(tool.position, goal, atol=1e-6)
    assert np.allclose(tool.R_base_tool, kinematics.R_base_tool_down, atol=1e-5)
    assert np.all((kinematics.lower <= q) & (q <= kinematics.upper))


def test_robot_starts_where_the_scenario_says(robot):
    sample = make_robot(SCENARIO).sample()
    assert np.allclose(sample.position, SCENARIO.start, atol=1e-6)
    assert sample.joints == pytest.approx(SCENARIO.robot.joints, abs=1e-4)
    assert np.linalg.norm(sample.orientation) == pytest.approx(1.0)
    assert sample.velocity == (0.0, 0.0, 0.0)


def test_unreachable_start_is_one_clear_line():
    scenario = replace_setting(SCENARIO, "start", [1.2, 0.0, 0.3])
    with pytest.raises(ScenarioError, match=r"start: unreachable by the UR5 .*\(1\.2, 0, 0\.3\)") as error:
        make_robot(scenario)
    assert "\n" not in str(error.value)


def test_start_with_the_arm_in_an_obstacle_is_refused():
    elbow = [{"id": "elbow", "position": [0.05, -0.1, 0.5], "radius": 0.12}]
    with pytest.raises(ScenarioError, match=r"start: the UR5's arm reaches .* 'elbow'"):
        make_robot(replace_setting(SCENARIO, "obstacles", elbow))


def test_self_collision_at_the_start_is_refused(monkeypatch):
    folded = np.array([0.0, -1.57, 3.0, 1.2, 0.0, 0.0])
    monkeypatch.setattr("farhand.robot_side.robots.pybullet_arm._start_configuration", lambda *_: folded)
    with pytest.raises(ScenarioError, match=r"start: \w+ and \w+ of the UR5 touch there"):
        make_robot(SCENARIO)


def test_of_an_arm_that_stands_so_itself_it_is_said_where_to_move_it():
    with pytest.raises(ScenarioError, match=r"touch there; the arm stands so: move it at the pendant"):
        ArmWorld(SCENARIO, np.array([0.0, -1.57, 3.0, 1.2, 0.0, 0.0]))


def test_arm_clearance_follows_what_it_is_asked_about(robot):
    make = make_robot(SCENARIO)
    assert make.arm_clearance([]) is None
    x, y, z = SCENARIO.start
    below = Obstacle("below", (x, y, z - 0.25), 0.05)
    assert make.arm_clearance([below]) == pytest.approx(0.2, abs=0.005)
    assert make.arm_clearance([Obstacle("below", (x, y, z - 0.35), 0.05)]) == pytest.approx(0.3, abs=0.005)
    far = Obstacle("far", (3.0, 0.0, 0.0), 0.05)
    assert make.arm_clearance([far, below]) == pytest.approx(0.2, abs=0.005)
    make.close()


def test_visuals_are_not_loaded():
    assert "<visual" not in UR5.urdf
    assert "package://" not in UR5.urdf
