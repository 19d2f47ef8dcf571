"""Near the end of a joint's range: the way to a stop is one that joints can go, and who is chased may still flee."""

import numpy as np
import pytest

from farhand.common.shapes.obstacle import Obstacle
from farhand.common.shapes.sphere import Sphere
from farhand.robot_side.arm.model import model
from farhand.robot_side.kernel.stopping import stop_angle
from farhand.robot_side.safety.guard.arm_guard import ArmGuard, Joints
from farhand.robot_side.safety.guard.settings import GuardSettings
from farhand.robot_side.scene.surroundings import surroundings_of
from farhand.trials.safety.arm_run import DT, LAG, KinematicArm
from farhand.trials.safety.guard import Trial, run_case

UR5 = model("ur5")
BALL = Obstacle(id="ball", position=(-0.75, 0.0, 0.6), shape=Sphere(0.08))
SHARE, REACTION = 0.5, DT + 1.5 * LAG
"""What the check counts on, see arm_guard.py."""
LATE = 0.05
"""rad: until something is near enough to be watched nothing is done about it."""


@pytest.mark.parametrize("obeys", [0.5, 1.0, 1.5])
def test_all_joints_stand_before_one_is_at_the_end_of_its_range(obeys):
    guard = ArmGuard(UR5, GuardSettings(), LAG, DT)
    body = KinematicArm(UR5.home, LAG, obeys * UR5.max_acceleration)
    around = surroundings_of([BALL])
    wanted = np.ascontiguousarray(UR5.tool_pose(UR5.home)[0])
    commanded, asked, beyond = np.zeros(6), np.array([0.4, -3.0, 0.8, 1.6, 0.0, 2.5]), []
    for _ in range(600):
        told = Joints(body.q, body.qd, commanded)
        commanded = guard.command(told, np.zeros(3), np.zeros(3), wanted, around, asked=asked).copy()
        end = stop_angle(commanded, UR5.max_acceleration, SHARE, REACTION)
        at_last = body.q + end * commanded
        beyond.append(np.maximum(at_last - UR5.upper, UR5.lower - at_last).max())
        body.step(commanded)
    assert body.q[1] < UR5.lower[1] + 0.2  # it did come there
    assert max(beyond) < LATE


@pytest.mark.parametrize(("robot", "index"), [("ur5", 23), ("panda", 8)])
def test_who_is_chased_to_the_end_of_a_range_still_flees(robot, index):
    case = Trial(robots=(robot,), speeds=(0.3,)).cases()[index]
    found = run_case(1, case)
    assert not found.error
    assert found.nearest >= 0.01, (
        f"{found.part} {found.nearest * 1e3:.1f} mm to {found.obstacle}: {found.reason}"
    )
