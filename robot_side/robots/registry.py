"""Which robots there are; each is imported only when it is asked for."""

from farhand.common.scenario import Scenario
from farhand.robot_side.robots.robot import Robot


def make_robot(scenario: Scenario) -> Robot:
    """The scenario's robot at the scenario's start.

    Raises ScenarioError when the robot cannot stand there.
    """
    kind = scenario.robot.kind
    if kind == "point":
        from farhand.robot_side.robots.point import PointRobot

        return PointRobot(scenario.start, scenario.robot.lag)
    if kind == "box":
        from farhand.robot_side.robots.pybullet_box import BoxRobot

        return BoxRobot(scenario.start)
    from farhand.robot_side.robots.pybullet_arm import UR5Robot

    return UR5Robot(scenario)
