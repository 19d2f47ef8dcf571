"""A program on a host whose time of day jumps; the monotonic clock stays true, as it does where an
administrator or NTP steps the time. By a small library that is preloaded (false_clock.c)."""

import os
import shutil
import signal
import subprocess
from pathlib import Path

from farhand.common.errors import FarhandError
from farhand.trials.faults.rig import Rig

SOURCE = Path(__file__).with_suffix(".c")
TOLERANCE = 5


def why_no_false_clock() -> str:
    """Why there is none here, or an empty string."""
    return "" if shutil.which("cc") else "needs a C compiler (Debian: gcc)"


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
        self._offset.write_bytes(bytes(8))
        library = rig.folder / "false_clock.so"
        command = ["cc", "-O2", "-shared", "-fPIC", str(SOURCE), "-o", str(library)]
        subprocess.run(command, check=True, timeout=60)
        self._environment = {"LD_PRELOAD": str(library), "FALSE_CLOCK": str(self._offset)}
        rig.end_and_restart(self._program, signal.SIGTERM, 0.0, self._environment)

    def jump(self, seconds: int) -> None:
        """The time of day leaps, under the running program; checked by a second process under the same clock."""
        before = self._time_of_day()
        with self._offset.open("r+b") as file:
            file.write(seconds.to_bytes(8, "little", signed=True))
        leapt = self._time_of_day() - before
        if abs(leapt - seconds) > TOLERANCE:
            raise FarhandError(f"the clock of the {self._program} leapt by {leapt} s, not by {seconds} s")

    def clean_up(self, rig: Rig) -> None:
        """Restart the program with the true clock."""
        rig.end_and_restart(self._program, signal.SIGTERM, 0.0)

    def _time_of_day(self) -> int:
        environment = {**os.environ, **self._environment}
        done = subprocess.run(
            ["date", "+%s"], env=environment, capture_output=True, text=True, check=True, timeout=10
        )
        return int(done.stdout)
