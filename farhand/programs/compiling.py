"""The first run on a machine compiles what runs at every tick: said, where it takes long."""

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from farhand.operator_side.control.controller import Controller
from farhand.operator_side.prepare import prepare

SAY_AFTER = 1.0
LINE = "compiling the solver, once on this machine: some 20 s ..."
ROBOT_LINE = "compiling the robot's control, once on this machine: some 40 s ..."


@contextmanager
def said_aloud(line: str, tell: Callable[[str], None], patience: float = SAY_AFTER) -> Iterator[None]:
    """Where what is done within takes longer than `patience` (s), have it said.

    Args:
        line: what is said.
        tell: takes the line, from a thread of its own.
        patience: in s.
    """
    waiting = threading.Timer(patience, tell, [line])
    waiting.daemon = True
    waiting.start()
    try:
        yield
    finally:
        waiting.cancel()


def prepare_aloud(controller: Controller, tell: Callable[[str], None], patience: float = SAY_AFTER) -> None:
    """Prepare a controller, see `said_aloud`."""
    with said_aloud(LINE, tell, patience):
        prepare(controller)
