"""Speed of the solvers, side by side on the same ticks of the same drives.

`python -m benchmarks.solver [--quick] [--json FILE]`. Newton: the compiled default. SQP: CasADi,
condensed, pruned. Ipopt: the full problem, cold at each tick, as the paper ran it. Milliseconds for one
call of Controller.solve. "Need a solve" are the ticks at which the optimum without obstacles is not the
answer. The last row is the compiled solver beside itself without planes, on spheres only: what the shapes cost it.
"""

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from msgspec import structs

from benchmarks.solver_instances import SETTINGS, closed_loop
from benchmarks.solver_shapes import ROUNDS, in_turn, without_planes
from farhand.common.timing.clock import SystemClock, stopwatch_seconds, to_ns
from farhand.operator_side.control.controller import Controller, ControlProblem, Status
from farhand.operator_side.control.ipopt import IpoptController
from farhand.operator_side.control.newton import NewtonController
from farhand.operator_side.control.sqp import SqpController

COUNTS = (1, 10, 100)
TICKS = 600
IPOPT_TICKS = 90  # spread over the same drives: it is slow
IDLE_TICKS = 100
SHAPES_WANTED = 1.05
"""Of the kernel over the one without planes, at most."""
PATIENT = structs.replace(SETTINGS, wall_time_limit=10.0)

FIRST_CALL = """
from farhand.common.timing.clock import stopwatch_seconds
start = stopwatch_seconds()
from farhand.operator_side.control.settings import ControllerSettings
from farhand.operator_side.control.registry import make_controller
make_controller(ControllerSettings()).prepare()
print(stopwatch_seconds() - start)
"""


def timed(controller: Controller, problems: Sequence[ControlProblem], idle: float = 0.0) -> Any:
    """(len(problems),) seconds for each solve in turn; a new drive starts without a warm start."""
    clock = SystemClock()
    controller.prepare()
    controller.reset()
    seconds = np.empty(len(problems))
    for index, problem in enumerate(problems):
        if index and problem.centres is not problems[index - 1].centres:
            controller.reset()
        if idle:
            clock.sleep_until(clock.now_ns() + to_ns(idle))
        start = stopwatch_seconds()
        controller.solve(problem)
        seconds[index] = stopwatch_seconds() - start
    return seconds


def _spread(indices: Any, number: int) -> Any:
    """As many of the indices, evenly spread."""
    return indices[np.unique(np.linspace(0, len(indices) - 1, number).astype(int))]


def percentiles(seconds: Any) -> dict[str, float]:
    """Median and 99th percentile in ms."""
    return {"median": float(np.median(seconds) * 1e3), "p99": float(np.percentile(seconds, 99) * 1e3)}


def first_call(times: int) -> float:
    """Import and first call from the cache in a fresh process (s), the best of some."""
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    command = [sys.executable, "-c", FIRST_CALL]
    texts = [
        subprocess.run(
            command, env=environment, capture_output=True, text=True, check=True, timeout=120
        ).stdout
        for _ in range(times)
    ]
    return min(float(text) for text in texts)


def run(quick: bool = False) -> dict[str, Any]:
    """All figures; ratios are of the medians, Ipopt cold over the others."""
    counts, number, ipopt_ticks = (COUNTS[1:2], 60, 1) if quick else (COUNTS, TICKS, IPOPT_TICKS)
    result: dict[str, Any] = {"obstacles": {}, "first_call": first_call(1 if quick else 3)}
    spheres = without_planes(lambda function: function) if quick else without_planes()
    for count in counts:
        ticks = list(closed_loop(number, seed=3, counts=(count,)))
        problems = [problem for problem, _ in ticks]
        hard = np.array([solution.status is not Status.SHORTCUT for _, solution in ticks])
        newton = timed(NewtonController(SETTINGS), problems)
        sqp = timed(SqpController(SETTINGS), problems)
        every = np.arange(number)
        some = np.unique(np.concatenate([_spread(every, ipopt_ticks), _spread(every[hard], ipopt_ticks)]))
        cold = IpoptController(PATIENT, warm=False)
        cold.solve(problems[0])
        for before, after in pairwise(problems):  # programs are built once for each number of obstacles
            if before.centres is not after.centres:
                cold.solve(after)
        ipopt = timed(cold, [problems[k] for k in some])
        idle = timed(NewtonController(SETTINGS), problems[:IDLE_TICKS], idle=0.0 if quick else 0.02)
        with_planes, only_spheres = in_turn(
            problems[:2] if quick else problems, SETTINGS, spheres, 1 if quick else ROUNDS
        )
        row: dict[str, Any] = {
            "solved_ticks": int(hard.sum()),
            "newton": percentiles(newton),
            "newton_solved": percentiles(newton[hard]),
            "newton_after_idle": percentiles(idle),
            "sqp": percentiles(sqp),
            "sqp_solved": percentiles(sqp[hard]),
            "ipopt": percentiles(ipopt[np.isin(some, _spread(every, ipopt_ticks))]),
            "ipopt_solved": percentiles(ipopt[hard[some]]),
        }
        for name in ("newton", "sqp"):
            for suffix in ("", "_solved"):
                slow = row[f"ipopt{suffix}"]["median"]
                row[f"ratio_{name}{suffix}"] = slow / row[f"{name}{suffix}"]["median"]
        row["shapes"] = float(with_planes.sum() / only_spheres.sum())
        result["obstacles"][str(count)] = row
    return result


def print_table(result: dict[str, Any]) -> None:
    """The figures as a table."""
    names = {
        "newton": "Newton, all ticks",
        "newton_solved": "Newton, ticks that need a solve",
        "newton_after_idle": "Newton, all ticks, after 20 ms idle",
        "sqp": "SQP, all ticks",
        "sqp_solved": "SQP, ticks that need a solve",
        "ipopt": "Ipopt cold, all ticks",
        "ipopt_solved": "Ipopt cold, ticks that need a solve",
    }
    counts = list(result["obstacles"])
    print(
        f"{'ms, median / p99 (times faster)':36}" + "".join(f"{count + ' obstacles':>26}" for count in counts)
    )
    for key, name in names.items():
        cells = []
        for count in counts:
            row = result["obstacles"][count]
            ratio = f" ({row['ratio_' + key]:.0f}x)" if "ratio_" + key in row else ""
            cells.append(f"{row[key]['median']:.3f} / {row[key]['p99']:.3f}{ratio}")
        print(f"{name:36}" + "".join(f"{cell:>26}" for cell in cells))
    cells = "".join(f"{result['obstacles'][count]['shapes']:>26.3f}" for count in counts)
    print(f"{'shapes: time over spheres only':36}{cells}   wanted: {SHAPES_WANTED:g} at most")
    print(f"import and first call, compiled code from the cache: {result['first_call']:.2f} s")


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description="speed of the solvers")
    parser.add_argument("--json", type=Path, help="write the figures to this file as well")
    parser.add_argument("--quick", action="store_true", help="to see that it works; the figures mean nothing")
    arguments = parser.parse_args()
    result = run(arguments.quick)
    print_table(result)
    if arguments.json:
        arguments.json.write_text(json.dumps(result, indent=2))


if __name__ == "__main__":
    main()
