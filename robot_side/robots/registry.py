"""The robots by name. A new one is one file and one line here, or an entry point of another package.

Each is imported only when it is asked for.
"""

from typing import TYPE_CHECKING

from farhand.common.kinds import Kinds, made
from farhand.robot_side.robots.settings import RobotScenario

if TYPE_CHECKING:
    from farhand.robot_side.robots.robot import Robot

ROBOTS: "Kinds[type[Robot]]" = Kinds(
    "robot",
    "farhand.robots",
    "farhand.robot_side.robots.robot:Robot",
    {
        "arm": "farhand.robot_side.robots.pybullet_arm:ArmRobot",
        "ur5": "farhand.robot_side.robots.pybullet_arm:ArmRobot",
        "ur": "farhand.robot_side.robots.ur_arm:UrRobot",
        "box": "farhand.robot_side.robots.pybullet_box:BoxRobot",
        "point": "farhand.robot_side.robots.point:PointRobot",
    },
)


def make_robot(scenario: RobotScenario) -> "Robot":
    """The scenario's robot at the scenario's start.

    Raises ScenarioError when the robot cannot stand there, InputError when there is no such robot, or it cannot be
    had: whatever a kind raises, such as a ConnectionError of a driver, is told in one line.
    """
    kind = ROBOTS.get(scenario.robot.kind, "robot.kind")
    _check_clear(scenario, kind)
    return made(f"robot {scenario.robot.kind!r}", lambda: kind.for_scenario(scenario))


def check_scenario(scenario: RobotScenario) -> None:
    """Raise ScenarioError when the scenario's robot cannot stand at its start, where its kind can tell.

    Builds no robot and connects to nothing. Raises InputError when there is no such robot.
    """
    kind = ROBOTS.get(scenario.robot.kind, "robot.kind")
    kind.check_start(scenario)
    _check_clear(scenario, kind)


def prepare_robot(scenario: RobotScenario) -> None:
    """Compile, or load, what the scenario's robot needs, before anything is connected or in time."""
    kind = ROBOTS.get(scenario.robot.kind, "robot.kind")
    kind.prepare(scenario)
    if scenario.guard.on and not kind.guards_itself:
        from farhand.robot_side.safety.guard.tool_guard import ToolGuard

        ToolGuard(scenario.guard, scenario.robot.radius, scenario.robot.lag, 1.0 / scenario.robot.rate_hz)


def _check_clear(scenario: RobotScenario, kind: "type[Robot]") -> None:
    """Raise ScenarioError where a robot that does not guard itself starts nearer to something than it may come."""
    if scenario.guard.on and not kind.guards_itself:
        from farhand.robot_side.safety.guard.start import check_tool_clear

        check_tool_clear(scenario, scenario.robot.radius)
