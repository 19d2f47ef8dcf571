"""The operator's side as a program: the node on the real clock, its reports published."""

import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import msgspec

from farhand.common.link.link import Link, Packet
from farhand.common.messages.codec import encode
from farhand.common.messages.keys import kind_of, mirror_key, report_key
from farhand.common.messages.report import ControlReport
from farhand.common.timing.clock import SystemClock, to_ns, to_seconds
from farhand.common.timing.loop import RealtimeLoop
from farhand.common.timing.slot import Slot
from farhand.operator_side.operator_node import OperatorNode


@dataclass(frozen=True, slots=True)
class OperatorOutcome:
    """Attributes:
    finished: the device has nothing left to do.
    duration: from the first motion command to the end (s).
    overruns: late ticks.
    lateness_p99: of the ticks (s).
    has_realtime_priority: whether SCHED_FIFO was granted.
    """

    finished: bool
    duration: float
    overruns: int
    lateness_p99: float
    has_realtime_priority: bool


class ReportPublisher:
    """A listener that sends each report on; it counts in the node's thread, the link has a thread of its own.

    Args:
        link: where reports go, on this side of the network only.
        name: the robot's name.
        beside: what the program knows beside its node at an instant: other values of the report's fields; must not
            wait.
    """

    def __init__(self, link: Link, name: str, beside: Callable[[int], dict[str, Any]] = lambda _: {}) -> None:
        self._link, self._key, self._beside = link, report_key(name), beside

    def __call__(self, report: ControlReport) -> None:
        """Send one report."""
        told = msgspec.structs.replace(report, **self._beside(report.t_sent_ns))
        self._link.send(Packet(self._key, encode(told)))


class MirroredLink:
    """A link whose sent packets others on this side of the network see as well, and the newest of which they keep.

    Args:
        link: to the robot.
        reports: to those others; its publishing thread does the work.
        name: the robot's name.
    """

    def __init__(self, link: Link, reports: Link, name: str) -> None:
        self._link, self.mirror = link, Mirror(reports, name)

    def send(self, packet: Packet) -> None:
        """Send it, and mirror it."""
        self._link.send(packet)
        self.mirror(packet)

    def receive(self) -> list[Packet]:
        """As of the link itself."""
        return self._link.receive()


class Mirror:
    """Passes on what it is called with, undecoded, under a key of its own; the newest of a kind wins.

    Args:
        reports: where to.
        name: the robot's name.
    """

    def __init__(self, reports: Link, name: str) -> None:
        self._reports, self._name = reports, name

    def __call__(self, packet: Packet) -> None:
        """Queue it for the publishing thread."""
        self._reports.send(Packet(mirror_key(self._name, kind_of(packet.key)), packet.payload))


class Driver(Protocol):
    """What a time limit looks at."""

    @property
    def waits(self) -> bool:
        """Whether another session holds control."""
        ...

    @property
    def driving_since_ns(self) -> int | None:
        """Instant of the first motion command."""
        ...


class TimeLimit:
    """Time from the first motion command on; until there is one, from the start, or since another operator gave
    control up. While another one holds control, no time counts.

    Args:
        node: drives.
        limit_ns: None: no limit.
        start_ns: of the program.
    """

    def __init__(self, node: Driver, limit_ns: int | None, start_ns: int) -> None:
        self._node, self._limit_ns = node, limit_ns
        self._looked_ns, self._spent_ns = start_ns, 0
        self._drove = False

    def is_up(self, now_ns: int) -> bool:
        """Whether it is over; to be asked again and again, several times a second."""
        since_ns = self._node.driving_since_ns
        if not self._node.waits:
            self._spent_ns += now_ns - self._looked_ns
        elif since_ns is None:
            self._spent_ns = 0
        if since_ns is not None and not self._drove:
            self._drove, self._spent_ns = True, now_ns - since_ns
        self._looked_ns = now_ns
        return self._limit_ns is not None and self._spent_ns >= self._limit_ns


def run_operator(
    node: OperatorNode,
    clock: SystemClock,
    stop_event: threading.Event,
    *,
    time_limit: float | None = None,
    slot: Slot | None = None,
    realtime: bool = True,
) -> OperatorOutcome:
    """Run a prepared node until its device is finished, the time is up or `stop_event` is set.

    Args:
        node: the node, with its listeners; its solver is compiled already.
        clock: of this process.
        stop_event: ends it.
        time_limit: see TimeLimit (s); None: no limit.
        slot: through which other threads change the node.
        realtime: ask for SCHED_FIFO.
    """
    limit = TimeLimit(node, None if time_limit is None else to_ns(time_limit), clock.now_ns())

    def over(now_ns: int) -> bool:
        late = limit.is_up(now_ns)
        done = (node.finished and node.device.ends_with_targets) or node.device.over
        return done or bool(node.fault) or late or stop_event.is_set()

    loop = RealtimeLoop(node, clock, realtime=realtime, until=over)
    if slot is not None:
        loop.before.append(slot.serve)
    loop.run()
    now_ns = clock.now_ns()
    node.release(now_ns)
    since_ns = node.driving_since_ns
    duration = to_seconds((loop.ended_ns or now_ns) - since_ns) if since_ns is not None else 0.0
    return OperatorOutcome(
        finished=node.finished,
        duration=duration,
        overruns=node.report.overruns if node.report is not None else 0,
        lateness_p99=loop.lateness.quantile(0.99),
        has_realtime_priority=loop.has_realtime_priority,
    )
