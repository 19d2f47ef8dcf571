"""The first run on a machine compiles the solver: said, where it takes long."""

import threading
from collections.abc import Callable

from farhand.operator_side.control.controller import Controller
from farhand.operator_side.prepare import prepare

SAY_AFTER = 1.0
"""(s). Loading what is compiled takes less, unless the machine is busy, so the line promises no compilation."""
LINE = "preparing the solver; the first time on a machine it is compiled, in some 20 s ..."


def prepare_aloud(controller: Controller, tell: Callable[[str], None], patience: float = SAY_AFTER) -> None:
    """Prepare a controller; where that takes longer than `patience` (s), have it said.

    Args:
        controller: to be prepared.
        tell: takes the line, from a thread of its own.
        patience: in s.
    """
    waiting = threading.Timer(patience, tell, [LINE])
    waiting.daemon = True
    waiting.start()
    try:
        prepare(controller)
    finally:
        waiting.cancel()
