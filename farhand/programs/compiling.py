"""The first run on a machine compiles the solver, and the robot's guard: said, where it takes long."""

import threading
from collections.abc import Callable

from farhand.operator_side.control.controller import Controller
from farhand.operator_side.prepare import prepare
from farhand.robot_side.robots.registry import prepare_robot
from farhand.robot_side.robots.settings import RobotScenario

SAY_AFTER = 1.0
"""(s). Loading what is compiled takes less, unless the machine is busy, so the line promises no compilation."""
LINE = "preparing the solver; the first time on a machine it is compiled, in some 20 s ..."
ROBOT_LINE = "preparing the robot's guard; the first time on a machine it is compiled, in a minute or so ..."


def prepare_aloud(controller: Controller, tell: Callable[[str], None], patience: float = SAY_AFTER) -> None:
    """Prepare a controller; where that takes longer than `patience` (s), have it said.

    Args:
        controller: to be prepared.
        tell: takes the line, from a thread of its own.
        patience: in s.
    """
    aloud(lambda: prepare(controller), lambda: tell(LINE), patience)


def prepare_robot_aloud(
    scenario: RobotScenario, tell: Callable[[str], None], patience: float = SAY_AFTER
) -> None:
    """Prepare what a scenario's robot needs compiled; where that takes longer than `patience` (s), have it said."""
    aloud(lambda: prepare_robot(scenario), lambda: tell(ROBOT_LINE), patience)


def aloud(work: Callable[[], None], tell: Callable[[], None], patience: float = SAY_AFTER) -> None:
    """Do it; where that takes longer than `patience` (s), `tell` is called, from a thread of its own."""
    waiting = threading.Timer(patience, tell)
    waiting.daemon = True
    waiting.start()
    try:
        work()
    finally:
        waiting.cancel()
