"""Fakes for tests, ours and yours: what stands in for one part of Farhand while another is tested.

    from farhand.testing import ScriptedLink, command, state

Messages with sensible defaults (`state`, `scene`, `description`, `command`, `report`, `echo_of`), an `obstacle` for a
scene, a controller's problem (`problem`), a device, a robot, a controller and a link that do what the test says and
keep what they were told, and the real programs as child processes (`Program`, `Programs`) with a witness of what the
robot says (`Witness`). Nothing here imports a test framework; what did not happen in time is an AssertionError.
"""

from farhand.testing.controller import ScriptedController
from farhand.testing.device import ScriptedDevice, view
from farhand.testing.link import ScriptedLink
from farhand.testing.messages import (
    OPERATOR_SESSION,
    ROBOT_SESSION,
    command,
    description,
    echo_of,
    obstacle,
    report,
    scene,
    state,
)
from farhand.testing.problems import problem
from farhand.testing.programs import Program, Programs, ask_farhand
from farhand.testing.robot import ScriptedRobot
from farhand.testing.tasks import short_task
from farhand.testing.witness import Witness

__all__ = [
    "OPERATOR_SESSION",
    "ROBOT_SESSION",
    "Program",
    "Programs",
    "ScriptedController",
    "ScriptedDevice",
    "ScriptedLink",
    "ScriptedRobot",
    "Witness",
    "ask_farhand",
    "command",
    "description",
    "echo_of",
    "obstacle",
    "problem",
    "report",
    "scene",
    "short_task",
    "state",
    "view",
]
