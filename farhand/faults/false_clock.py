"""A program on a host whose time of day jumps, by libfaketime; the monotonic clock stays true, as it does
where an administrator or NTP steps the time."""

import signal
import subprocess
from pathlib import Path

from common.errors import FarhandError
from farhand.faults.rig import Rig

LIBRARY = next(iter(Path("/usr/lib").glob("*/faketime/libfaketime.so.1")), None)
TOLERANCE = 5


def why_no_false_clock() -> str:
    """Why there is none here, or an empty string."""
    return "" if LIBRARY is not None else "needs libfaketime (Debian: faketime)"


class FalseClock:
    """The time of day that one program sees.

    Args:
        program: operator, netem or robot.
    """

    def __init__(self, program: str) -> None:
        self._program = program
        self._offset = Path()
        self._environment: dict[str, str] = {}

    def prepare(self, rig: Rig) -> None:
        """Restart the program with a clock that is still right."""
        self._offset = rig.folder / f"clock-of-{self._program}"
        self._environment = {
            "LD_PRELOAD": str(LIBRARY),
            "FAKETIME_TIMESTAMP_FILE": str(self._offset),
            "FAKETIME_NO_CACHE": "1",
            "FAKETIME_DONT_FAKE_MONOTONIC": "1",
        }
        self._write(0)
        rig.end_and_restart(self._program, signal.SIGTERM, 0.0, self._environment)

    def jump(self, seconds: int) -> None:
        """The time of day leaps, under the running program; checked by a second process under the same clock."""
        before = self._time_of_day()
        self._write(seconds)
        leapt = self._time_of_day() - before
        if abs(leapt - seconds) > TOLERANCE:
            raise FarhandError(f"the clock of the {self._program} leapt by {leapt} s, not by {seconds} s")

    def clean_up(self, rig: Rig) -> None:
        """Restart the program with the true clock."""
        rig.end_and_restart(self._program, signal.SIGTERM, 0.0)

    def _write(self, seconds: int) -> None:
        part = self._offset.with_suffix(".new")
        part.write_text(f"{seconds:+d}\n")
        part.replace(self._offset)

    def _time_of_day(self) -> int:
        command = ["date", "+%s"]
        done = subprocess.run(
            command, env=self._environment, capture_output=True, text=True, check=True, timeout=10
        )
        return int(done.stdout)
