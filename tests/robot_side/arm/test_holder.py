"""What the arm says holds it."""

import numpy as np
import pytest

from farhand.robot_side.arm.holder import holder
from farhand.robot_side.arm.kinematics import Kinematics
from farhand.robot_side.arm.model import model

KINEMATICS = Kinematics(model("ur5"))
FREE = np.array([-0.85369, -1.35254, 1.66821, -1.88646, -1.5708, -0.85369])


def said(q, wanted, commanded=None):
    jacobian = KINEMATICS.tool(q).jacobian
    return holder(KINEMATICS, q, jacobian, np.zeros(6) if commanded is None else commanded, np.array(wanted))


def test_an_arm_that_follows_is_held_by_nothing():
    jacobian = KINEMATICS.tool(FREE).jacobian
    wanted = np.array([0.1, 0.0, 0.05])
    follows = np.linalg.solve(jacobian, np.concatenate([wanted, np.zeros(3)]))
    assert said(FREE, wanted, follows) == ""
    assert said(FREE, (0.001, 0.0, 0.0)) == ""


def test_a_stretched_arm_is_at_the_edge_of_its_reach():
    q = FREE.copy()
    q[2] = 0.02
    assert said(q, (0.2, -0.2, 0.0)) == "the edge of its reach"


def test_a_singular_wrist():
    q = FREE.copy()
    q[4] = 0.01
    assert said(q, (0.1, 0.1, 0.0)) == "a singularity of the wrist"


@pytest.mark.parametrize("sign", [1, -1])
def test_a_joint_at_its_limit_is_named_only_if_it_is_wanted_further(sign):
    q = FREE.copy()
    q[2] = KINEMATICS.upper[2] - 0.4  # bent, but not singular
    at_limit = Kinematics(model("ur5"))
    at_limit.upper = at_limit.upper.copy()
    at_limit.upper[2] = q[2] + 0.01
    jacobian = KINEMATICS.tool(q).jacobian
    wanted = sign * jacobian[:3, 2] * 0.2 / np.linalg.norm(jacobian[:3, 2])
    free = np.linalg.lstsq(jacobian, np.concatenate([wanted, np.zeros(3)]), rcond=None)[0]
    found = holder(at_limit, q, jacobian, np.zeros(6), wanted)
    assert (found == "joint limit of elbow_joint") == (free[2] > 0)


def test_too_fast_for_a_joint():
    assert said(FREE, (30.0, 0.0, 0.0)).startswith("speed limit of ")
