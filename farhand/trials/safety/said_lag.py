"""A robot that follows with another lag than it says: what do predictions, clearance and time lose?

    python -m farhand.trials.safety.said_lag --tasks 20 --workers 2

Each task is one of Table I's, done by the operator's side alone, without a guard. The robot answers with the lag that
it has, and says another: the share that is asked for. Prints, for each network and share, the least clearance, how many
finished, the time against the same task with the true lag said, the mean and the 95th percentile of the errors of
prediction, and what lag was identified meanwhile; exit code 1 if any run came below d_min.
"""

import argparse
import statistics
import sys
from collections.abc import Sequence
from concurrent.futures import Executor
from contextlib import closing, nullcontext
from typing import Any

import msgspec
import numpy as np

from farhand.laboratory.campaigns.pools import LocalPool
from farhand.laboratory.campaigns.tasks import OWN_EFFORT, BoxKind, make_task
from farhand.laboratory.simulation import simulate_run
from farhand.robot_side.robots.registry import make_robot
from farhand.runs.run import Run
from farhand.runs.scenario import load_scenario, replace_settings

NETWORKS = ("none", "uniform:50,200", "bursty-loss-20")
SHARES = (1.0, 0.5, 1.5)
"""Of the true lag, that the robot says; the first is the one that the others are held against."""
ROBOTS: tuple[BoxKind | str, ...] = ("point", "box", "ur5")
TIME_LIMIT = 120.0


class Outcome(msgspec.Struct, frozen=True):
    """Of one run.

    Attributes:
        clearance: smallest, of the tool's sphere (m).
        finished: whether every target was reached.
        seconds: until then, or to the end.
        errors: of prediction, a tick each (m).
        identified: the lag (s); None: not known.
    """

    clearance: float
    finished: bool
    seconds: float
    errors: list[float]
    identified: float | None


def drive(robot: str, index: int, network: str, share: float) -> Outcome:
    """Task `index`, of a robot that says so much of its lag. Of an arm there is one task, its scenario's."""
    if robot in ("point", "box"):
        true = make_task(1, index, "box" if robot == "box" else "point", effort=OWN_EFFORT)
    else:
        true = load_scenario(f"{robot}-obstacle")
    true = replace_settings(true, {"guard.on": False})
    said = replace_settings(true, {"robot.lag": share * true.robot.lag})
    run = msgspec.structs.replace(Run.over(said, network, seed=index), time_limit=TIME_LIMIT)
    with closing(make_robot(true)) as answers:
        result = simulate_run(run, robot=answers, keep_reports=True)
    summary, operator = result.summary, result.summary.counts.operator
    return Outcome(
        clearance=summary.min_clearance if summary.min_clearance is not None else float("nan"),
        finished=summary.finished,
        seconds=summary.duration or 0.0,
        errors=[report.prediction_error for report in result.reports],
        identified=operator.lag if operator is not None else None,
    )


def main(words: Sequence[str] | None = None) -> int:
    """Run, print, return the exit code."""
    options = _parser().parse_args(words)
    tasks = range(options.tasks if options.robot in ("point", "box") else 1)
    low = 0
    with LocalPool(options.workers).open() if options.workers else nullcontext() as executor:
        for network in options.network or NETWORKS:
            first: list[Outcome] = []
            for share in SHARES:
                found = _all(executor, [(options.robot, index, network, share) for index in tasks])
                first = first or found
                low += sum(each.clearance < 0.01 for each in found)
                print(_line(network, share, found, first), flush=True)
    return 1 if low else 0


def _all(executor: Executor | None, runs: list[tuple[str, int, str, float]]) -> list[Outcome]:
    if executor is None:
        return [drive(*each) for each in runs]
    return [future.result() for future in [executor.submit(drive, *each) for each in runs]]


def _line(network: str, share: float, found: list[Outcome], first: list[Outcome]) -> str:
    errors = np.concatenate([each.errors for each in found])
    times: list[Any] = [
        a.seconds / b.seconds for a, b in zip(found, first, strict=True) if a.finished and b.finished
    ]
    known = [each.identified for each in found if each.identified is not None]
    lag = f"{1e3 * statistics.median(known):.0f} ms" if known else "not known"
    return (
        f"{network}: says {share:g} of its lag: least {1e3 * min(e.clearance for e in found):.1f} mm, "
        f"{sum(e.finished for e in found)} of {len(found)} finished, time {statistics.median(times or [0.0]):.3f}, "
        f"error {1e3 * errors.mean():.1f} and {1e3 * np.percentile(errors, 95):.1f} mm, identified {lag}"
    )


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m farhand.trials.safety.said_lag",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--tasks", type=int, default=20, help="for each network and share")
    parser.add_argument("--robot", choices=ROBOTS, default="point", help="an arm has one task")
    parser.add_argument(
        "--network", action="append", help=f"SPEC; again for more; else {', '.join(NETWORKS)}"
    )
    parser.add_argument("--workers", type=int, default=0, help="processes; 0: this one alone")
    return parser


if __name__ == "__main__":
    sys.exit(main())
