"""A recorded run again, on the same topics with the run's own stamps, and `/clock`: for runs of virtual time, too."""

from collections.abc import Iterator

from farhand.bridges.ros2.cdr.types import Types
from farhand.bridges.ros2.graph.node import Publisher
from farhand.bridges.ros2.outbound.outward import Outward
from farhand.common.link.link import Packet
from farhand.common.messages.keys import mirror_key, report_key
from farhand.common.recording.records import RunInfo, TickRecord

CLOCK = "rosgraph_msgs/msg/Clock"
NANOSECONDS = 1_000_000_000


class RunPlayback:
    """Told the time of this process; what it tells has the run's.

    Args:
        ticks: of the run, in order.
        info: of the run.
        outward: tells it.
        clock: of `/clock`.
        types: of the distribution.
        speed: times as fast as it was.

    Attributes:
        over: whether all of it was told.
    """

    def __init__(self, ticks: Iterator[TickRecord], info: RunInfo, outward: Outward, clock: Publisher, types: Types,
                 speed: float) -> None:  # fmt: skip
        self.over = False
        self._ticks, self._outward, self._clock, self._types = ticks, outward, clock, types
        self._robot, self._epoch_ns, self._speed = info.robot, info.epoch_ns, speed
        self._next = next(ticks, None)
        self._first_ns = self._next.now_ns if self._next is not None else 0
        self._begun_ns: int | None = None

    def step(self, now_ns: int) -> int | None:
        """Tell what is due; see Node."""
        self._begun_ns = now_ns if self._begun_ns is None else self._begun_ns
        while self._next is not None and self._due_ns(self._next, self._begun_ns) <= now_ns:
            self._tell(self._next)
            self._next = next(self._ticks, None)
        self.over = self._next is None
        return None if self._next is None else self._due_ns(self._next, self._begun_ns)

    def _due_ns(self, tick: TickRecord, begun_ns: int) -> int:
        return begun_ns + round((tick.now_ns - self._first_ns) / self._speed)

    def _tell(self, tick: TickRecord) -> None:
        sec, nanosec = divmod(tick.now_ns + self._epoch_ns, NANOSECONDS)
        time = self._types.make("builtin_interfaces/msg/Time", sec=sec, nanosec=nanosec)
        self._clock.put(self._types.make(CLOCK, clock=time))
        for key, arrived_ns, payload in tick.packets:
            self._outward.hand_on(Packet(key, payload, arrived_ns), arrived_ns)
        if tick.command is not None:
            self._outward.hand_on(
                Packet(mirror_key(self._robot, "command"), tick.command, tick.now_ns), tick.now_ns
            )
        self._outward.hand_on(Packet(report_key(self._robot), tick.report, tick.now_ns), tick.now_ns)
        self._outward.look(tick.now_ns)
