"""Compile what both sides compile, into the cache: `python -m farhand.laboratory.warm`."""

import sys

from farhand.common.timing.clock import stopwatch_seconds
from farhand.laboratory.simulation import simulate

SCENARIOS = ("ur5-obstacle", "point-obstacle")
"""An arm, and a robot without one: they have different guards."""


def main() -> int:
    """Begin a task of each kind, with a line of progress before and after; returns the exit code."""
    print("compiling solver and robots (some 80 s when the cache is empty) ...", flush=True)
    start = stopwatch_seconds()
    for scenario in SCENARIOS:
        simulate(scenario, network="none", time_limit=0.5)
    print(f"compiled in {stopwatch_seconds() - start:.1f} s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
