"""The operator's side as a program: the node on the real clock, its reports published, its recording kept."""

import threading
from collections.abc import Callable
from dataclasses import dataclass

from farhand.common.link.link import Link, Packet
from farhand.common.messages.codec import encode
from farhand.common.messages.keys import report_key
from farhand.common.messages.report import ControlReport
from farhand.common.timing.clock import SystemClock, to_ns, to_seconds
from farhand.common.timing.executor import RealtimeExecutor
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


class _Program:
    """What the executor runs: the node, and around it reports and the end of the task."""

    def __init__(
        self,
        node: OperatorNode,
        name: str,
        report_link: Link | None,
        time_limit: float | None,
        stopped: Callable[[], bool],
        watch: Callable[[ControlReport], None] | None,
    ) -> None:
        self.stop: Callable[[], None] = lambda: None
        self.end_ns: int | None = None
        self._node, self._key, self._report_link = node, report_key(name), report_link
        self._limit_ns = None if time_limit is None else to_ns(time_limit)
        self._stopped, self._watch = stopped, watch
        self._start_ns: int | None = None
        self._seen: ControlReport | None = None

    def step(self, now_ns: int) -> int:
        """One tick, then a look at whether it was the last."""
        if self._start_ns is None:
            self._start_ns = now_ns
        next_ns = self._node.step(now_ns)
        report = self._node.report
        if report is not None and report is not self._seen:
            self._seen = report
            if self._report_link is not None:
                self._report_link.send(Packet(self._key, encode(report)))
            if self._watch is not None:
                self._watch(report)
        since_ns = self._node.driving_since_ns or self._start_ns
        late = self._limit_ns is not None and now_ns - since_ns >= self._limit_ns
        if self._node.finished or late or self._stopped():
            self.end_ns = now_ns
            self.stop()
        return next_ns


def run_operator(
    node: OperatorNode,
    name: str,
    clock: SystemClock,
    stop_event: threading.Event,
    *,
    report_link: Link | None = None,
    time_limit: float | None = None,
    watch: Callable[[ControlReport], None] | None = None,
    realtime: bool = True,
) -> OperatorOutcome:
    """Run a prepared node until its device is finished, the time is up or `stop_event` is set.

    Args:
        node: the node; its solver is compiled already.
        name: the robot's name.
        clock: of this process.
        stop_event: ends it.
        report_link: where reports go, on this side of the network only.
        time_limit: after the first motion command, or after the start if there was none (s); None: no limit.
        watch: called with each report; must be quick.
        realtime: ask for SCHED_FIFO.
    """
    program = _Program(node, name, report_link, time_limit, stop_event.is_set, watch)
    executor = RealtimeExecutor(program, clock, realtime=realtime)
    program.stop = executor.stop
    executor.run()
    now_ns = clock.now_ns()
    node.release(now_ns)
    since_ns = node.driving_since_ns
    duration = to_seconds((program.end_ns or now_ns) - since_ns) if since_ns is not None else 0.0
    return OperatorOutcome(
        finished=node.finished,
        duration=duration,
        overruns=node.report.overruns if node.report is not None else 0,
        lateness_p99=executor.lateness.quantile(0.99),
        has_realtime_priority=executor.has_realtime_priority,
    )
