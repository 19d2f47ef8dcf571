"""Compile the solver into the cache: `python -m farhand.operator_side.warm`."""

import sys

from farhand.common.timing.clock import stopwatch_seconds
from farhand.operator_side.control.registry import make_controller
from farhand.operator_side.control.settings import ControllerSettings
from farhand.operator_side.prepare import prepare


def main() -> int:
    """Compile, with a line of progress before and after; returns the exit code."""
    print("compiling the controller (some 20 s when the cache is empty) ...", end=" ", flush=True)
    start = stopwatch_seconds()
    controller = make_controller(ControllerSettings())
    prepare(controller)
    print(f"done in {stopwatch_seconds() - start:.1f} s")
    if controller.solver_notice:
        print(controller.solver_notice)
    return 0


if __name__ == "__main__":
    sys.exit(main())
