"""A loop at the robot's rate and with its priority that does nothing: the periods that the machine alone makes it miss.

`python -m farhand.trials.ur.idle_loop RATE` prints at its end how many periods there were, and how many it missed.
"""

import os
import subprocess
import sys

from farhand.common.process.signals import PARENT_VARIABLE, die_with_parent, stop_event_on_signals
from farhand.common.timing.clock import SystemClock
from farhand.common.timing.periodic import Periodic
from farhand.common.timing.realtime import request_realtime


class IdleLoop:
    """Such a loop in a process of its own, from now on.

    Args:
        rate_hz: of its periods.
    """

    def __init__(self, rate_hz: float) -> None:
        environment = {**os.environ, PARENT_VARIABLE: str(os.getpid())}
        command = [sys.executable, "-m", "farhand.trials.ur.idle_loop", f"{rate_hz:g}"]
        self._process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, text=True, env=environment
        )

    def end(self) -> float:
        """End it; the share of its periods that it missed."""
        self._process.terminate()
        ticks, missed = self._process.communicate(timeout=20.0)[0].split()
        return int(missed) / max(1, int(ticks))


def main() -> None:
    """Until told to end."""
    die_with_parent()
    stop_event, clock = stop_event_on_signals(), SystemClock()
    ticks, periods = 0, Periodic(round(1e9 / float(sys.argv[1])))
    request_realtime()
    while not stop_event.is_set():
        ticks += min(1, periods.due(clock.now_ns()))
        next_ns = periods.next_ns
        clock.sleep_until(next_ns if next_ns is not None else clock.now_ns())
    print(ticks, periods.overruns)


if __name__ == "__main__":
    main()
