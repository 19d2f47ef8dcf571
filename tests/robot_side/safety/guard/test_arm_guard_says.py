"""An arm that steps aside says so, also where its tool hardly moves."""

import numpy as np
import pytest

from farhand.common.shapes.obstacle import Obstacle
from farhand.common.shapes.sphere import Sphere
from farhand.robot_side.arm.model import model
from farhand.robot_side.safety.guard.arm_guard import STIRS, ArmGuard, Joints
from farhand.robot_side.safety.guard.settings import GuardSettings
from farhand.robot_side.scene.surroundings import surroundings_of
from farhand.trials.safety.arm_run import DT, LAG, KinematicArm


@pytest.mark.parametrize("name", ["ur5", "panda"])
def test_nothing_that_flees_unasked_keeps_silent(name):
    arm = model(name)
    guard = ArmGuard(arm, GuardSettings(), LAG, DT)
    body = KinematicArm(arm.home, LAG, arm.max_acceleration)
    wanted = np.ascontiguousarray(arm.tool_pose(arm.home)[0])
    elbow = arm.poses(arm.home)[1][2 if name == "ur5" else 3]
    commanded, said = np.zeros(arm.n), []
    for tick in range(1500):
        away = np.array([0.0, 0.5 - 0.1 * tick * DT, 0.0])
        ball = Obstacle(
            id="ball", position=tuple(elbow + away), shape=Sphere(0.08), velocity=(0.0, -0.1, 0.0)
        )
        told = Joints(body.q, body.qd, commanded)
        around = surroundings_of([ball])
        commanded = guard.command(told, np.zeros(3), np.zeros(3), wanted, around).copy()
        if np.abs(commanded).max() > STIRS:
            said.append(guard.did.what if guard.did is not None else "")
        body.step(commanded)
    assert said[0] == "evading"
    assert said.count("evading") > 0.8 * len(said)  # for a few periods in between nothing has to be done
