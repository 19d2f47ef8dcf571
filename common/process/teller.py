"""Lines for people from threads that must not wait for a terminal."""

from farhand.common.process.signals import say
from farhand.common.timing.handoff import Handoff

WAITING_LINES = 256
CLOSING_TIME = 1.0


class Teller:
    """Says lines on stderr in a thread of its own, however slowly they are read there.

    Args:
        program: its name, before each line.

    Attributes:
        lost: lines that found no place among the 256 that may wait; said once there is place again.
    """

    def __init__(self, program: str) -> None:
        self._program = program
        self._said_lost = 0
        self._lines: Handoff[str] = Handoff(self._say, "teller", WAITING_LINES, self._say_lost)

    @property
    def lost(self) -> int:
        """How many lines were not said."""
        return self._lines.lost

    def say(self, line: str) -> None:
        """Have a line said; never waits."""
        self._lines.put(line)

    def close(self) -> None:
        """Say what waits, for at most a second."""
        self._lines.close(CLOSING_TIME)

    def _say(self, line: str) -> None:
        try:
            say(self._program, line)
        except (OSError, ValueError):
            pass  # nobody reads any more

    def _say_lost(self) -> None:
        lost, self._said_lost = self._lines.lost - self._said_lost, self._lines.lost
        if lost:
            self._say(f"{lost} more lines, faster than they could be written")
