"""The robots by name. A new one is one file and one line here, or an entry point of another package.

Each is imported only when it is asked for.
"""

from farhand.common.kinds import Kinds
from farhand.robot_side.robots.robot import Robot
from farhand.robot_side.settings import RobotScenario

ROBOTS: Kinds[type[Robot]] = Kinds(
    "robot",
    "farhand.robots",
    Robot,
    {
        "ur5": "farhand.robot_side.robots.pybullet_arm:UR5Robot",
        "box": "farhand.robot_side.robots.pybullet_box:BoxRobot",
        "point": "farhand.robot_side.robots.point:PointRobot",
    },
)


def make_robot(scenario: RobotScenario) -> Robot:
    """The scenario's robot at the scenario's start.

    Raises ScenarioError when the robot cannot stand there, InputError when there is no such robot.
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


def check_scenario(scenario: Scenario) -> None:
    """Raise ScenarioError when the scenario's robot cannot stand at its start; connects to nothing."""
    if scenario.robot.kind == "ur5":
        from farhand.robot_side.robots.pybullet_arm import check_start

        check_start(scenario)
