"""The first run on a machine compiles what runs at every tick: said where it is so, and where it takes long."""

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from farhand.common.compiled import when_compiling
from farhand.operator_side.control.controller import Controller
from farhand.operator_side.prepare import prepare
from farhand.robot_side.robots.registry import check_scenario, prepare_robot
from farhand.robot_side.robots.settings import RobotScenario

SAY_AFTER = 1.0
"""(s) from the first function that is compiled: what takes less is not said."""
LINE = "compiling the solver, once on this machine; some 20 s ..."
ROBOT_LINE = "compiling the robot's control, once on this machine; a minute or so ..."


@contextmanager
def said_aloud(line: str, tell: Callable[[str], None], patience: float = SAY_AFTER) -> Iterator[None]:
    """Where something within is really compiled, and takes longer than `patience` (s), have it said.

    What is loaded, as in every later run, is not: however busy the machine is.

    Args:
        line: what is said.
        tell: takes the line, from a thread of its own.
        patience: in s.
    """
    waiting = threading.Timer(patience, tell, [line])
    waiting.daemon = True

    def begins() -> None:
        if waiting.ident is None:
            waiting.start()

    with when_compiling(begins):
        try:
            yield
        finally:
            waiting.cancel()


def prepare_aloud(controller: Controller, tell: Callable[[str], None], patience: float = SAY_AFTER) -> None:
    """Prepare a controller, see `said_aloud`; raises InputError where it cannot."""
    with said_aloud(LINE, tell, patience):
        prepare(controller)


def prepare_robot_aloud(
    scenario: RobotScenario, tell: Callable[[str], None], patience: float = SAY_AFTER
) -> None:
    """Prepare what a scenario's robot needs, after a look at whether it can stand at its start at all.

    Raises ScenarioError where it cannot.
    """
    with said_aloud(ROBOT_LINE, tell, patience):
        check_scenario(scenario)
        prepare_robot(scenario)
