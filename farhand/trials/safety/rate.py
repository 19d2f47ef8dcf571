"""Is 50 Hz as safe as 10 Hz, on every named network? And how much sooner does the robot answer?

    python -m farhand.trials.safety.rate --tasks 200 --out runs/rate

Each task is one of Table I's with the box, guard off, so that the operator's side alone keeps it safe; one in ten as
many is of a UR5 among clutter with its guard on. Every task is done at each rate (rates.py) over every network, with
the same seeds. The answer is measured beside it (answering.py). Prints one table, kept in --out with every row; a trial
that was stopped goes on with the same --out. Exit code 1 if any task came below d_min or crashed.
"""

import argparse
import statistics
import sys
from collections.abc import Sequence
from pathlib import Path

import msgspec

from farhand.common.errors import FarhandError
from farhand.common.process.console import page
from farhand.common.result_file import write_whole
from farhand.laboratory.campaigns.jobs import Job, Row
from farhand.laboratory.campaigns.pools import LocalPool
from farhand.laboratory.campaigns.run_table1 import run_with_progress
from farhand.laboratory.campaigns.store import Store, source_digest
from farhand.laboratory.campaigns.tasks import OWN_EFFORT, BoxKind, make_task
from farhand.netem.models.profiles import PROFILES
from farhand.programs.wiring import versions
from farhand.runs.run import Run
from farhand.runs.scenario import Scenario, replace_settings
from farhand.trials.safety.answering import Answers, drive
from farhand.trials.safety.clutter import cluttered_task
from farhand.trials.safety.rates import RATES, Rate, with_rate

NETWORKS = ("none", "gaussian:50,20", "constant:200", "uniform:50,200", *PROFILES)
"""The paper's, and all that have a name."""
BOXES: tuple[BoxKind, ...] = ("box", "point")
TIME_LIMIT = 240.0
ARM_SHARE = 10
"""One UR5 task for so many of the box."""
ARM_TIME_LIMIT = 90.0
COMPUTING_TIME = 0.005
"""Of a tick, at every rate (s): ten times what is measured."""
TABLE = "rate.md"


def jobs_for(options: argparse.Namespace) -> list[Job]:
    """Every task over every network at every rate."""
    arms = [] if options.no_arm else range(max(1, options.tasks // ARM_SHARE))
    boxes = [
        make_task(options.seed, index, options.robot, effort=OWN_EFFORT) for index in range(options.tasks)
    ]
    tasks = [(options.robot, index, scenario, TIME_LIMIT) for index, scenario in enumerate(boxes)]
    tasks += [("ur5", index, _arm_task(options.seed, index), ARM_TIME_LIMIT) for index in arms]
    found = []
    for network in options.network or NETWORKS:
        for robot, index, scenario, limit in tasks:
            for rate in options.rate or ("10", "50"):
                run = msgspec.structs.replace(
                    Run.over(with_rate(scenario, rate), network, seed=index),
                    time_limit=limit,
                    computing_time=(COMPUTING_TIME,),
                )
                labels = {"network": network, "robot": robot, "task": index, "rate": rate}
                found.append(Job(key=f"{network}/{robot}/{index}/{rate}", labels=labels, run=run))
    return found


def _arm_task(seed: int, index: int) -> Scenario:
    return replace_settings(cluttered_task(seed, index), {"steering.tester": {"sidestep": True}})


def table(rows: Sequence[Row], answers: dict[tuple[str, Rate], Answers]) -> str:
    """One line a network and robot, as Markdown, and below it what came below d_min."""
    rates = [rate for rate in RATES if any(row.labels["rate"] == rate for row in rows)]
    head = ["network", "robot", "tasks"]
    for what in ("below d_min", "finished", "least (mm)", "stops"):
        head += [f"{what}, {rate}" for rate in rates]
    head += [f"time, {rate} : {rates[0]}" for rate in rates[1:]]
    for what in ("command after (ms)", "robot after (ms)"):
        head += [f"{what}, {rate}" for rate in rates]
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    groups: dict[tuple[str, str], dict[Rate, list[Row]]] = {}
    for row in rows:
        key = row.labels["network"], row.labels["robot"]
        groups.setdefault(key, {rate: [] for rate in rates})[row.labels["rate"]].append(row)
    for (network, robot), group in groups.items():
        each = [group[rate] for rate in rates]
        cells: list[object] = [network, robot, len(each[0])]
        cells += [sum(map(_is_bad, one)) for one in each]
        cells += [sum(row.finished for row in one) for one in each]
        cells += [_least(one) for one in each]
        cells += [sum(row.stops for row in one) for one in each]
        cells += [_ratio(each[0], one) for one in each[1:]]
        timed = [answers.get((network, rate)) for rate in rates]
        cells += [_after(one.commands) if one else "–" for one in timed]
        cells += [_after(one.robots) if one else "–" for one in timed]
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    bad = [f"- {row.key}: {row.error or _least([row]) + ' mm'}" for row in rows if _is_bad(row)]
    late = [f"- {row.key}: {row.why}" for row in rows if not row.finished and not row.error]
    return "\n".join([*lines, "", *bad, *late]).rstrip() + "\n"


def _is_bad(row: Row) -> bool:
    return bool(row.error) or not row.safe


def _least(rows: Sequence[Row]) -> str:
    least = [row.min_clearance for row in rows if row.min_clearance is not None]
    least += [row.min_arm_clearance for row in rows if row.min_arm_clearance is not None]
    return f"{1e3 * min(least):.1f}" if least else "–"


def _ratio(ones: Sequence[Row], others: Sequence[Row]) -> str:
    """Mean over the tasks finished at both rates."""
    first = {row.labels["task"]: row.duration for row in ones if row.finished}
    both = [
        row.duration / before
        for row in others
        if row.finished and row.duration and (before := first.get(row.labels["task"]))
    ]
    return f"{statistics.mean(both):.3f}" if both else "–"


def _after(times: Sequence[float]) -> str:
    """Median and 95 %."""
    if not times:
        return "–"
    late = times[min(len(times) - 1, int(0.95 * len(times)))]
    return f"{1e3 * statistics.median(times):.0f}, {1e3 * late:.0f}"


def main(words: Sequence[str] | None = None) -> int:
    """Run, print, return the exit code."""
    options = _parser().parse_args(words)
    console = page()
    rates, networks = options.rate or ["10", "50"], options.network or list(NETWORKS)
    about = {
        "trial": "rate",
        "tasks": options.tasks,
        "seed": options.seed,
        "robot": options.robot,
        "arm": not options.no_arm,
        "selection": {"networks": networks, "rates": rates},
        "code": source_digest(),
        "versions": versions(),
    }
    try:
        store: Store[Row] = Store(options.out, about)
        rows, _ = run_with_progress(jobs_for(options), store, LocalPool(options.workers), console)
        answers = {(net, rate): drive(net, rate, COMPUTING_TIME) for net in networks for rate in rates}
    except FarhandError as error:
        print(f"rate: {error}", file=sys.stderr)
        return 2
    text = table(rows, answers)
    write_whole(options.out / TABLE, text)
    print(text, end="", flush=True)
    return 1 if any(map(_is_bad, rows)) else 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m farhand.trials.safety.rate",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--tasks", type=int, default=20, help="of the box, for each network and rate")
    parser.add_argument("--seed", type=int, default=1, help="of the tasks")
    parser.add_argument("--robot", choices=BOXES, default="box", help="a body in PyBullet, or kinematic")
    parser.add_argument("--no-arm", action="store_true", help="leave the UR5 out")
    parser.add_argument("--network", action="append", help="SPEC; again for more; else every named one")
    parser.add_argument("--rate", action="append", choices=RATES, help="again for more; else 10 and 50")
    parser.add_argument("--workers", type=int, default=0, help="processes; 0: one for each processor")
    parser.add_argument("--out", type=Path, default=Path("runs/rate"), help="folder of the results")
    return parser


if __name__ == "__main__":
    sys.exit(main())
