"""The emulated controller of a UR arm on the robot's host: told by its terminal, read by its log."""

import re
from pathlib import Path

from farhand.common.errors import FarhandError
from farhand.common.timing.clock import SystemClock, to_ns
from farhand.trials.hosts import Hosts

RATE_HZ = 125.0
PATIENCE = 300.0
"""s until it is there: on a new machine much is compiled before."""
ANSWERS_WITHIN = 10.0
_STOOD = re.compile(r"it stood after ([0-9.]+) s|it has not stood")


class Controller:
    """Started, and there.

    Args:
        hosts: which end it.
        log: file for what it says.
        scenario: whose arm it has, at its start.

    Raises FarhandError where it does not start.
    """

    def __init__(self, hosts: Hosts, log: Path, scenario: Path) -> None:
        self._log, self._clock = log, SystemClock()
        words = ("ur", "emulator", "--rate", f"{RATE_HZ:g}", "--scenario", str(scenario))
        pipe = hosts.start("robot", "farhand", *words, log=log, told=True).stdin
        assert pipe is not None
        self._pipe = pipe
        self._wait_for(re.compile("Ctrl-C"), 0, PATIENCE)

    def mark(self) -> None:
        """Count from now on for how long the arm moves."""
        self._tell("mark")

    def stood(self) -> float | None:
        """After how long it first stood, by the controller's own clock (s); None: it moved on and on."""
        at = len(self._said())
        self._tell("stood")
        found = self._wait_for(_STOOD, at, ANSWERS_WITHIN)
        return float(found[1]) if found[1] else None

    def _tell(self, line: str) -> None:
        self._pipe.write(f"{line}\n")
        self._pipe.flush()

    def _said(self) -> str:
        return self._log.read_text(errors="replace")

    def _wait_for(self, what: re.Pattern[str], at: int, patience: float) -> re.Match[str]:
        """The first that it says, after the first `at` characters; raises FarhandError."""
        end_ns = self._clock.now_ns() + to_ns(patience)
        while (found := what.search(self._said(), at)) is None:
            now_ns = self._clock.now_ns()
            if now_ns > end_ns:
                raise FarhandError(f"the emulated controller does not answer: {self._said()[-500:]}")
            self._clock.sleep_until(now_ns + to_ns(0.05))
        return found
