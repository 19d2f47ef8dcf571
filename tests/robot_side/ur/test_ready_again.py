"""An arm that can be driven again says so in other words than those that stopped it."""

from types import SimpleNamespace

from farhand.robot_side.robots.ur_arm import UrRobot
from farhand.robot_side.ur.attention import Attention
from farhand.robot_side.ur.settings import UrSettings
from tests.robot_side.ur.test_states import facts


def test_what_stopped_it_is_said_until_it_is_over_and_then_once_that_it_is():
    robot = object.__new__(UrRobot)  # without a controller
    robot._follower, robot._was = SimpleNamespace(forget=lambda: None), ""
    robot._attention = Attention(UrSettings())

    def says(**values):
        robot._facts = facts(**values)
        return robot.stopped_by()

    assert says(answer_age=0.2).startswith("Farhand's program")
    assert says() == "the robot's program has just started: acknowledge to drive"
    assert says() == ""
    assert says(safety_mode=3).startswith("protective stop: look why")
    assert says(runtime_state=1).startswith("Farhand's program does not run")
    assert says() == "ready again, acknowledge to drive; until now: protective stop"
    assert says() == ""
