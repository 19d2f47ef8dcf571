"""The robots by name. A new one is one file and one line here, or an entry point of another package.

Each is imported only when it is asked for.
"""

import traceback
from pathlib import Path
from typing import TYPE_CHECKING

from farhand.common.errors import FarhandError, InputError
from farhand.common.kinds import Kinds
from farhand.robot_side.robots.settings import RobotScenario

if TYPE_CHECKING:
    from farhand.robot_side.robots.robot import Robot

ROBOTS: "Kinds[type[Robot]]" = Kinds(
    "robot",
    "farhand.robots",
    "farhand.robot_side.robots.robot:Robot",
    {
        "ur5": "farhand.robot_side.robots.pybullet_arm:UR5Robot",
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
    try:
        return kind.for_scenario(scenario)
    except FarhandError:
        raise
    except Exception as error:
        where = traceback.extract_tb(error.__traceback__)[-1]
        text = " ".join(f"{type(error).__name__}: {error}".split())
        raise InputError(
            f"robot {scenario.robot.kind!r} cannot be had: {text} ({Path(where.filename).name}, line {where.lineno})"
        ) from None


def check_scenario(scenario: RobotScenario) -> None:
    """Raise ScenarioError when the scenario's robot cannot stand at its start, where its kind can tell.

    Builds no robot and connects to nothing. Raises InputError when there is no such robot.
    """
    ROBOTS.get(scenario.robot.kind, "robot.kind").check_start(scenario)
