"""Random tasks for robots that follow slowly: how near does the body come?

    python -m farhand.trials.safety.lag --tasks 1000

Each task is one of Table I's (farhand/laboratory/campaigns/tasks.py) with a lag and a speed of its own, drawn from
the ranges asked for. Prints, for each network, how many came below d_min with the share's exact 95 % interval, the
least clearance and how many finished; exit code 1 if any came below.
"""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass

import msgspec

from farhand.common.seeds import stream
from farhand.laboratory.campaigns.jobs import Job, Row
from farhand.laboratory.campaigns.statistics import clopper_pearson
from farhand.laboratory.campaigns.tasks import OWN_EFFORT, BoxKind, make_task
from farhand.runs.run import Run
from farhand.runs.scenario import Scenario, replace_settings
from farhand.trials.safety.rows import rows_of

NETWORKS = ("none", "uniform:50,200")
ROBOTS: tuple[BoxKind, ...] = ("point", "box")
TIME_LIMIT = 300.0
LAG = (0.0, 1.0)
SPEED = (0.3, 2.0)


@dataclass(frozen=True, slots=True)
class Ranges:
    """What lag (s) and speed (m/s) are drawn from, evenly."""

    lag: tuple[float, float] = LAG
    speed: tuple[float, float] = SPEED


def draw_task(seed: int, index: int, robot: BoxKind, ranges: Ranges) -> Scenario:
    """Task `index`, with a lag and a speed of its own: the tester's, and the limit in the plane that it drives in."""
    draw = stream(seed, "lag", str(index))
    lag, speed = float(draw.uniform(*ranges.lag)), float(draw.uniform(*ranges.speed))
    tester = {"far_speed": speed, "near_speed": min(0.05, speed)}
    return replace_settings(
        make_task(seed, index, robot, effort=OWN_EFFORT),
        {"robot.lag": lag, "controller.speed_limit": [speed] * 3, "steering.tester": tester},
    )


def jobs_for(seed: int, tasks: int, network: str, robot: BoxKind, ranges: Ranges) -> list[Job]:
    """One job a task."""
    found = []
    for index in range(tasks):
        scenario = draw_task(seed, index, robot, ranges)
        run = msgspec.structs.replace(Run.over(scenario, network, seed=index), time_limit=TIME_LIMIT)
        labels = {
            "network": network,
            "robot": robot,
            "task": index,
            "lag": scenario.robot.lag,
            "speed": scenario.controller.speed_limit[0],
        }
        found.append(Job(key=f"{network}/{robot}/{index}", labels=labels, run=run))
    return found


def main(words: Sequence[str] | None = None) -> int:
    """Run, print, return the exit code."""
    options = _parser().parse_args(words)
    ranges = Ranges(tuple(options.lag), tuple(options.speed))
    bad = 0
    for network in options.network or NETWORKS:
        rows = rows_of(jobs_for(options.seed, options.tasks, network, options.robot, ranges), options.workers)
        bad += _tell(network, rows)
    return 1 if bad else 0


def _tell(network: str, rows: list[Row]) -> int:
    """One line for the network, one for each task below d_min; returns how many those are."""
    low = [row for row in rows if row.error or not row.safe]
    nearest = min((row.min_clearance for row in rows if row.min_clearance is not None), default=float("nan"))
    finished = sum(row.finished for row in rows)
    duration = sum(row.duration or 0.0 for row in rows)
    fewest, most = clopper_pearson(len(low), len(rows))
    print(
        f"{network}: {len(low)} of {len(rows)} below d_min ({100 * fewest:.2f} to {100 * most:.2f} %), "
        f"least {1e3 * nearest:.1f} mm, {finished} finished, {duration:.1f} s in all, "
        f"{sum(row.stops for row in rows)} stops",
        flush=True,
    )
    for row in sorted(low, key=lambda row: row.min_clearance or 0.0):
        clearance = "" if row.min_clearance is None else f"{1e3 * row.min_clearance:.1f} mm, "
        lag, speed = row.labels["lag"], row.labels["speed"]
        print(f"    task {row.labels['task']}: {clearance}lag {lag:.3f} s, {speed:.3f} m/s {row.error}")
    for row in rows:
        if not row.finished and not row.error:
            print(f"    task {row.labels['task']}: {row.why}, lag {row.labels['lag']:.3f} s", flush=True)
    return len(low)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m farhand.trials.safety.lag",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--tasks", type=int, default=100, help="for each network")
    parser.add_argument("--seed", type=int, default=1, help="of tasks, lags and speeds")
    parser.add_argument("--robot", choices=ROBOTS, default="point", help="kinematic, or a body in PyBullet")
    parser.add_argument(
        "--network", action="append", help=f"SPEC; again for more; else {', '.join(NETWORKS)}"
    )
    parser.add_argument("--lag", type=float, nargs=2, default=LAG, metavar=("LEAST", "MOST"), help="s")
    parser.add_argument("--speed", type=float, nargs=2, default=SPEED, metavar=("LEAST", "MOST"), help="m/s")
    parser.add_argument("--workers", type=int, default=1, help="processes; 0: this one alone")
    return parser


if __name__ == "__main__":
    sys.exit(main())
