"""The UR5's velocity control: response, direction, orientation, singularities, limits."""

import msgspec
import numpy as np
import pytest

from farhand.common.geometry import Twist, to_vector3, turn_between
from farhand.common.seeds import stream
from farhand.robot_side.arm.chain import ArmChain
from farhand.robot_side.arm.kinematics import Kinematics, rotation_error
from farhand.robot_side.arm.limits import JointBounds
from farhand.robot_side.arm.model import model
from farhand.robot_side.arm.velocity_control import DirectionKeeping
from farhand.robot_side.robots.pybullet_arm import ArmRobot
from farhand.runs.scenario import load_scenario, replace_setting

SCENARIO = msgspec.structs.replace(load_scenario("ur5-obstacle"), obstacles=())
UR5 = model("ur5")
DT = 0.002
A_MAX = SCENARIO.robot.max_joint_acceleration


def drive(start, velocity, seconds, law="direction"):
    """Positions and velocities at each tick (n, 3), joint velocities commanded (n, 6), worst turn (rad)."""
    scenario = replace_setting(SCENARIO, "robot.velocity_control", law)
    robot = ArmRobot(replace_setting(scenario, "start", list(start)))
    positions, velocities, commanded, turned = [], [], [], 0.0
    for _ in range(round(seconds / DT)):
        robot.step(Twist(to_vector3(velocity)), DT)
        sample = robot.sample()
        positions.append(sample.position)
        velocities.append(sample.velocity)
        commanded.append(robot._follower.commanded)
        error = rotation_error(robot.kinematics.R_base_tool_down, robot._follower._tool.R_base_tool)
        turned = max(turned, float(np.linalg.norm(error)))
    q = np.array(robot.sample().joints)
    assert getattr(robot.control, "failures", 0) == 0
    robot.close()
    return np.array(positions), np.array(velocities), np.array(commanded), turned, q


def off_line(positions, start, velocity):
    direction = np.array(velocity) / np.linalg.norm(velocity)
    moved = positions - np.array(start)
    return float(np.max(np.linalg.norm(moved - np.outer(moved @ direction, direction), axis=1)))


@pytest.mark.parametrize("velocity", [(0.0, 0.3, 0.0), (0.0, 0.0, 0.2), (0.2, 0.2, 0.0)])
def test_step_response(velocity):
    positions, velocities, commanded, turned, _ = drive(SCENARIO.start, velocity, 0.6)
    speed = np.linalg.norm(velocity)
    along = velocities @ np.array(velocity) / speed
    assert np.argmax(along >= 0.9 * speed) * DT <= 0.05
    assert along.max() <= 1.002 * speed
    assert along[-1] == pytest.approx(speed, abs=0.001)
    assert off_line(positions, SCENARIO.start, velocity) < 0.0005
    assert turned < np.radians(0.1)
    assert np.abs(np.diff(commanded, axis=0)).max() <= A_MAX * DT + 1e-9


CASES = [
    pytest.param((0.45, 0.0, 0.30), (0.3, 0.0, 0.0), 2.5, id="elbow stretched"),
    pytest.param((0.45, 0.0, 0.30), (-0.3, 0.02, 0.0), 2.0, id="over the shoulder"),
    pytest.param((0.45, 0.0, 0.30), (0.0, 0.0, 0.3), 2.5, id="up"),
    pytest.param((0.45, 0.0, 0.30), (0.0, 0.3, 0.0), 4.0, id="sideways out"),
    pytest.param((0.45, 0.0, 0.30), (0.0, 0.0, -0.3), 2.0, id="down"),
]


@pytest.mark.parametrize(("start", "velocity", "seconds"), CASES)
def test_line_is_kept_where_the_arm_cannot_follow(start, velocity, seconds):
    positions, _, commanded, turned, q = drive(start, velocity, seconds)
    kept = off_line(positions, start, velocity)
    bent = off_line(drive(start, velocity, seconds, "damped")[0], start, velocity)
    kinematics = Kinematics(UR5)
    assert kept < 0.012
    assert kept < bent / 4
    assert turned < np.radians(0.5)
    assert np.all(np.abs(commanded) <= kinematics.max_velocity + 1e-9)
    assert np.all((kinematics.lower - 1e-6 <= q) & (q <= kinematics.upper + 1e-6))


def test_resting_arm_does_not_creep():
    positions, *_ = drive(SCENARIO.start, (0.0, 0.0, 0.0), 6.0)
    assert np.linalg.norm(positions[-1] - np.array(SCENARIO.start)) < 5e-6


def test_bounds_brake_before_the_limit():
    bounds = JointBounds(np.array([-1.0]), np.array([1.0]), np.array([3.0]), A_MAX)
    q, qd = np.array([0.0]), np.array([0.0])
    for _ in range(2000):
        low, high = bounds.at(q, qd, DT)
        assert low <= high
        assert abs(high - qd) <= A_MAX * DT + 1e-12
        qd = high
        q = q + qd * DT
        assert q[0] <= 1.0 + 1e-9
    assert q[0] == pytest.approx(1.0, abs=1e-3)


def test_acceleration_wins_over_a_limit_that_comes_too_late():
    bounds = JointBounds(np.array([-1.0]), np.array([1.0]), np.array([3.0]), A_MAX)
    low, high = bounds.at(np.array([1.2]), np.array([2.0]), DT)
    assert low == high == pytest.approx(2.0 - A_MAX * DT)


def test_nonsense_brakes_instead_of_raising():
    kinematics = Kinematics(UR5)
    bounds = JointBounds(kinematics.lower, kinematics.upper, kinematics.max_velocity, A_MAX)
    control = DirectionKeeping(bounds, kinematics.R_base_tool_down)
    q, rng = UR5.home, stream(3, "commands")
    tool = ArmChain(UR5).at(q, np.zeros(6))
    previous = np.full(6, 0.5)
    braked = control.joint_velocity(q, previous, tool, np.array([np.nan, 0.0, 0.0]), DT)
    assert control.failures == 1
    assert braked == pytest.approx(previous - A_MAX * DT)
    for _ in range(200):
        v = rng.normal(0, 1, 3) * 10 ** rng.uniform(-6, 6)
        qd = control.joint_velocity(q, np.zeros(6), tool, v, DT)
        assert np.abs(qd).max() <= A_MAX * DT + 1e-12


@pytest.mark.parametrize("law", ["direction", "damped"])
def test_the_tool_turns_as_commanded_while_it_moves_and_keeps_what_it_was_turned_to(law):
    scenario = replace_setting(SCENARIO, "robot.velocity_control", law)
    robot = ArmRobot(scenario)
    start, before = np.array(robot.sample().position), robot.sample().orientation
    linear, angular = (0.05, 0.1, 0.0), (0.0, 0.3, 0.4)
    for _ in range(500):
        robot.step(Twist(linear, angular), DT)
    assert robot.sample().angular_velocity == pytest.approx(angular, abs=5e-3)
    for _ in range(1000):
        robot.step(Twist(), DT)
    turn = turn_between(before, robot.sample().orientation)
    assert turn == pytest.approx(angular, abs=5e-3)  # for 1 s, less what it took to set in
    assert np.array(robot.sample().position) - start == pytest.approx(linear, abs=2e-3)
    assert np.abs(robot.sample().angular_velocity).max() < 1e-3
    robot.close()


LEAVING = [
    pytest.param((0.3, 0.0, 0.0), (-0.3, 0.0, 0.0), id="stretched, back"),
    pytest.param((0.3, 0.0, 0.0), (-0.27, 0.12, 0.0), id="stretched, towards the axis"),
    pytest.param((0.3, 0.0, 0.0), (0.0, 0.0, -0.3), id="stretched, down"),
    pytest.param((0.0, 0.0, 0.3), (0.0, 0.0, -0.3), id="up, down again"),
    pytest.param((0.0, 0.0, 0.3), (-0.3, 0.0, 0.0), id="up, sideways"),
]


@pytest.mark.parametrize(("there", "back"), LEAVING)
def test_the_edge_of_reach_is_left_at_once(there, back):
    robot = ArmRobot(SCENARIO)
    for _ in range(4000):
        robot.step(Twist(to_vector3(there)), DT)
    edge = np.array(robot.sample().position)
    direction = np.array(back) / np.linalg.norm(back)
    for _ in range(350):
        robot.step(Twist(to_vector3(back)), DT)
    moved = np.array(robot.sample().position) - edge
    robot.close()
    assert moved @ direction > 0.1  # within 0.7 s; at full speed 0.2
    assert np.linalg.norm(moved - (moved @ direction) * direction) < 0.002
