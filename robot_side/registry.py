"""Which robots there are; each is imported only when it is asked for."""

from common.scenario import Scenario
from robot_side.robot import Robot


def make_robot(scenario: Scenario) -> Robot:
    """The scenario's robot at the scenario's start.

    Raises ScenarioError when the robot cannot stand there.
    """
    kind = scenario.robot.kind
    if kind == "point":
        from robot_side.point import PointRobot

        return PointRobot(scenario.start, scenario.robot.lag)
    if kind == "box":
        from robot_side.pybullet_box import BoxRobot

        return BoxRobot(scenario.start)
    from robot_side.pybullet_ur5 import UR5Robot

    return UR5Robot(scenario)
