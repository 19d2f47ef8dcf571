"""Files of sweeps."""

import re
from collections.abc import Callable

from farhand.common.errors import InputError
from farhand.laboratory.campaigns.sweep import MAX_RUNS, Sweep
from farhand.trials.fuzz.files import scratch
from farhand.trials.fuzz.target import Target, check, one_line

SEED = """name = "gamma"
scenario = "point-obstacle"
network = "constant:{delay}"
seeds = 3
time_limit = 60.0

[grid]
"controller.gamma" = [0.3, 0.5]
delay = [50, 200]
"""
MANY = re.compile(rb"seeds\s*=\s*\+?(\w+)")
"""A million runs are a lawful wish, and take their time to be set up."""


def seeds() -> list[bytes]:
    """A scenario over a grid, and random tasks over both directions."""
    drawn = (
        'scenario = "random-tasks"\nuplink = "none"\nseeds = [1, 5]\ncomputing_time = 0\n'
        '[grid]\ndownlink = ["uniform:50,200", "gaussian:50,20 loss:1%"]\n'
    )
    return [SEED.encode(), drawn.encode()]


def start() -> Callable[[bytes], None]:
    """See Target."""
    path = scratch("sweep.toml")

    def take(data: bytes) -> None:
        if any(len(seeds) > 3 for seeds in MANY.findall(data)):
            return
        path.write_bytes(data)
        try:
            sweep = Sweep(path)
        except InputError as error:
            one_line(error)
            return
        check(1 <= len(sweep.jobs) <= MAX_RUNS, "no runs, or too many")
        check(len({job.key for job in sweep.jobs}) == len(sweep.jobs), "two runs of one name")

    return take


TARGET = Target(
    edge="sweeps",
    promise="a refusal is one line; every run has a name of its own",
    seeds=seeds,
    start=start,
    shape="text",
)
