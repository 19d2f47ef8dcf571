"""The operator's side as a program: the node on the real clock, its reports published."""

import threading
from collections.abc import Callable
from dataclasses import dataclass

import msgspec

from farhand.common.link.link import Link, Packet
from farhand.common.messages.codec import encode
from farhand.common.messages.keys import report_key
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
        connected: whether anybody on the robot's side is connected; must not wait.
    """

    def __init__(self, link: Link, name: str, connected: Callable[[], bool] = lambda: True) -> None:
        self._link, self._key, self._connected = link, report_key(name), connected

    def __call__(self, report: ControlReport) -> None:
        """Send one report."""
        if not self._connected():
            report = msgspec.structs.replace(report, connected=False)
        self._link.send(Packet(self._key, encode(report)))


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
        time_limit: after the first motion command; until there is one, after the start, or after another
            operator gave control up, which is waited for without a limit (s); None: no limit.
        slot: through which other threads change the node.
        realtime: ask for SCHED_FIFO.
    """
    limit_ns = None if time_limit is None else to_ns(time_limit)
    start_ns = clock.now_ns()

    def over(now_ns: int) -> bool:
        nonlocal start_ns
        if node.waits:
            start_ns = now_ns
        since_ns = node.driving_since_ns or start_ns
        late = limit_ns is not None and now_ns - since_ns >= limit_ns
        return node.finished or bool(node.fault) or late or stop_event.is_set()

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
