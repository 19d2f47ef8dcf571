"""A script of changes, in real or virtual time, from TOML:

[[at]]
time = 5.0             # s since the first message
do = "set"             # set | add | remove | outage | reset | common, see farhand.netem.action
direction = "uplink"   # or "downlink"; without it both
robot = "arm2"         # the robot whose own network is meant; without it the common one
spec = "gaussian:80,20 loss:1%"

[[at]]
time = 12.0
do = "outage"
length = 2.0           # s
"""

from pathlib import Path

import msgspec

from farhand.common.errors import InputError
from farhand.common.timing.clock import to_ns
from farhand.common.toml import read_toml
from farhand.netem.action import Action
from farhand.netem.netem_node import NetemNode

MAX_TIME = 1e6


class Step(Action, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """An action at a time.

    Attributes:
        time: since the first message (s).
    """

    time: float


class _File(msgspec.Struct, forbid_unknown_fields=True):
    at: list[Step]


class Timeline:
    """Performs its steps when they are due.

    Args:
        steps: in order of time.
    """

    def __init__(self, steps: list[Step]) -> None:
        self._steps = list(steps)
        self._origin_ns: int | None = None
        self._next = 0

    def start(self, origin_ns: int) -> None:
        """Set the instant that times count from."""
        self._origin_ns = origin_ns

    def due(self, now_ns: int) -> list[Step]:
        """The steps whose time has come, each once, in order."""
        found: list[Step] = []
        while (next_ns := self.next_ns()) is not None and next_ns <= now_ns:
            found.append(self._steps[self._next])
            self._next += 1
        return found

    def next_ns(self) -> int | None:
        """When the next step is due; None before the start and after the last."""
        if self._origin_ns is None or self._next >= len(self._steps):
            return None
        return self._origin_ns + to_ns(self._steps[self._next].time)

    def run(self, node: NetemNode, now_ns: int) -> int | None:
        """Perform what is due; returns when the next step is."""
        for step in self.due(now_ns):
            try:
                step.perform(node, now_ns)
            except InputError as error:
                # Whether there is something to remove is known only now; the run goes on without it.
                node.note(f"timeline at {step.time:g} s: {error}")
        return self.next_ns()


def load_timeline(path: str | Path) -> Timeline:
    """The timeline in a TOML file; raises InputError with the step and what is wrong with it."""
    where = f"timeline {path}"
    try:
        file = msgspec.convert(read_toml(path, "timeline"), _File)
    except msgspec.ValidationError as error:
        raise InputError(f"{where}: {' '.join(str(error).split())}") from None  # a key may hold a line feed
    last = 0.0
    for number, step in enumerate(file.at, start=1):
        if not 0 <= step.time <= MAX_TIME:
            raise InputError(f"{where}: step {number}: time {step.time} s lies outside 0 to {MAX_TIME:g}")
        if step.time < last:
            raise InputError(
                f"{where}: step {number}: time {step.time} s comes before that of the step above it, {last} s"
            )
        last = step.time
        try:
            step.check()
        except InputError as error:
            raise InputError(f"{where}: step {number}: {error}") from None
    return Timeline(file.at)
