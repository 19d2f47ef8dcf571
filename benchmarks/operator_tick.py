"""What the lag part and the check of the body add to the operator's tick, side by side in one run.

`python -m benchmarks.operator_tick [--quick] [--json FILE] [--tasks N]`. The point robot does some of Table I's tasks
in virtual time. At every tick that is filtered, a second safety filter without the two gets the same input and is timed
as well; each has a controller of its own. "Without" is the same tick with the second filter's time in place of the
first's.
"""

import argparse
import copy
import json
from pathlib import Path
from unittest.mock import patch

import numpy as np

from farhand.common.timing.clock import thread_seconds
from farhand.laboratory.campaigns.tasks import make_task
from farhand.laboratory.simulation import simulate
from farhand.operator_side.control.registry import make_controller
from farhand.operator_side.operator_node import OperatorNode
from farhand.operator_side.safety_filter import Ahead, Filtered, SafetyFilter

WHOLE, FILTER = OperatorNode.step, SafetyFilter.filter
NETWORKS = ("none", "uniform:50,200")
WANTED = 1.2
"""Of the tick with over the tick without, in the median."""
TASKS = 12
QUICK = 2.0
"""s of one task."""


class Times:
    """Seconds of every filtered tick: whole, its filter, and a filter without the parts."""

    def __init__(self) -> None:
        self.rows: list[tuple[float, float, float]] = []
        self._of_filters = (0.0, 0.0)
        self._seconds: dict[SafetyFilter, SafetyFilter] = {}

    def step(self, node: OperatorNode, now_ns: int) -> int:
        """A tick, timed."""
        self._of_filters = 0.0, 0.0
        began = thread_seconds()
        next_ns = WHOLE(node, now_ns)
        spent = thread_seconds() - began
        own, without = self._of_filters
        if own:
            self.rows.append((spent - without, own, without))
        return next_ns

    def filter(self, first: SafetyFilter, ahead: Ahead) -> Filtered:
        """Both filters, timed: whichever comes first finds a colder cache, so they take turns."""
        if first not in self._seconds:
            self._seconds[first] = without_the_parts(first)
        second = self._seconds[first]
        if len(self.rows) % 2:
            filtered, own = timed(first, ahead)
            _, without = timed(second, ahead)
        else:
            _, without = timed(second, ahead)
            filtered, own = timed(first, ahead)
        self._of_filters = own, without
        return filtered


def timed(one: SafetyFilter, ahead: Ahead) -> tuple[Filtered, float]:
    """What it filters, and how long that takes (s)."""
    began = thread_seconds()
    filtered = FILTER(one, ahead)
    return filtered, thread_seconds() - began


def without_the_parts(first: SafetyFilter) -> SafetyFilter:
    """The same filter with a controller of its own, without the lag part and the check of the body."""
    second = copy.copy(first)
    second._trail = None
    second._controller = make_controller(first._settings)
    second._controller.prepare()
    return second


def measure(network: str, tasks: int, time_limit: float = 300.0) -> dict[str, float]:
    """Medians, 99th percentiles (ms) and their ratios over all ticks of the tasks."""
    times = Times()
    with (
        patch.object(OperatorNode, "step", lambda node, now_ns: times.step(node, now_ns)),
        patch.object(SafetyFilter, "filter", lambda first, ahead: times.filter(first, ahead)),
    ):
        for index in range(tasks):
            simulate(make_task(1, index), network=network, seed=index, time_limit=time_limit)
    table = np.array(times.rows)
    tick, without = table[:, 0], table[:, 0] - table[:, 1] + table[:, 2]
    found = {"ticks": float(len(table))}
    for name, seconds in (
        ("with", tick),
        ("without", without),
        ("filter", table[:, 1]),
        ("filter_without", table[:, 2]),
    ):
        found[f"{name}_median"], found[f"{name}_p99"] = (
            float(v) for v in np.percentile(seconds, (50, 99)) * 1e3
        )
    found["ratio_median"] = found["with_median"] / found["without_median"]
    found["ratio_p99"] = found["with_p99"] / found["without_p99"]
    return found


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--json", type=Path, help="write the figures to this file as well")
    parser.add_argument("--tasks", type=int, default=TASKS, help=f"of Table I, a network [{TASKS}]")
    parser.add_argument("--quick", action="store_true", help="to see that it works; the figures mean nothing")
    options = parser.parse_args()
    measure("none", 1, QUICK)  # imports and compiled code
    amount = (1, QUICK) if options.quick else (options.tasks,)
    result = {network: measure(network, *amount) for network in NETWORKS}
    print(f"{'ms, median / p99':16}{'tick':>16}{'without':>16}{'ratio':>14}{'filter':>16}{'without':>16}")
    for network, row in result.items():
        cells = [
            f"{row[f'{name}_median']:.3f} / {row[f'{name}_p99']:.3f}"
            for name in ("with", "without", "filter", "filter_without")
        ]
        ratio = f"{row['ratio_median']:.2f} / {row['ratio_p99']:.2f}"
        print(f"{network:16}{cells[0]:>16}{cells[1]:>16}{ratio:>14}{cells[2]:>16}{cells[3]:>16}")
    print(f"wanted of the median's ratio: {WANTED:g} at most")
    if options.json is not None:
        options.json.write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
