"""Timelines of a network that changes."""

from collections.abc import Callable

from farhand.common.errors import InputError
from farhand.netem.timeline import load_timeline
from farhand.trials.fuzz.files import scratch
from farhand.trials.fuzz.target import Target, one_line

SEED = """[[at]]
time = 5.0
do = "set"
direction = "uplink"
robot = "arm2"
spec = "gaussian:80,20 loss:1%"

[[at]]
time = 12
do = "outage"
length = 2.0
hold = true

[[at]]
time = 13
do = "remove"
name = "loss"
"""


def seeds() -> list[bytes]:
    """One with every kind of step."""
    more = SEED + '[[at]]\ntime = 20\ndo = "common"\nrobot = "arm2"\n[[at]]\ntime = 21\ndo = "reset"\n'
    return [SEED.encode(), more.encode()]


def start() -> Callable[[bytes], None]:
    """See Target."""
    path = scratch("timeline.toml")

    def take(data: bytes) -> None:
        path.write_bytes(data)
        try:
            load_timeline(path)
        except InputError as error:
            one_line(error)

    return take


TARGET = Target(
    edge="timelines of netem", promise="a refusal is one line", seeds=seeds, start=start, shape="text"
)
