"""Who calls a node, and when.

A node is a synchronous object that is told the time. `RealtimeExecutor` runs one node against the
system clock, one process each. `VirtualExecutor` (virtual_executor.py) runs many in one process.
"""

import ctypes
import gc
import os
import threading
from typing import Protocol

from farhand.common.timing.clock import SystemClock

_PR_SET_TIMERSLACK = 29
STOP_CHECK_NS = 50_000_000


class Node(Protocol):
    """A synchronous participant of the system; owns no clock, no thread, no socket."""

    def step(self, now_ns: int) -> int | None:
        """Do all that is due at `now_ns`.

        Returns the absolute instant (ns) of the next wake-up, or None to sleep until a message arrives.
        """
        ...


class Periodic:
    """Absolute deadlines of a periodic activity: no drift, missed periods are counted as overruns.

    Args:
        period_ns: the period.
    """

    def __init__(self, period_ns: int) -> None:
        if period_ns <= 0:
            raise ValueError("a period must be positive")
        self.period_ns = period_ns
        self.next_ns: int | None = None
        self.overruns = 0

    def due(self, now_ns: int) -> int:
        """Number of periods that have come due at `now_ns` (0: none); the first call starts the series."""
        if self.next_ns is None:
            self.next_ns = now_ns + self.period_ns
            return 1
        if now_ns < self.next_ns:
            return 0
        periods = (now_ns - self.next_ns) // self.period_ns + 1
        self.overruns += periods - 1
        self.next_ns += periods * self.period_ns
        return periods


class Lateness:
    """How late wake-ups were: count, mean, maximum, and a histogram with power-of-two bins in us."""

    def __init__(self) -> None:
        self.count = 0
        self.total_ns = 0
        self.max_ns = 0
        self.bins = [0] * 24

    def add(self, late_ns: int) -> None:
        """Record one wake-up that came `late_ns` after its deadline."""
        late_ns = max(0, late_ns)
        self.count += 1
        self.total_ns += late_ns
        self.max_ns = max(self.max_ns, late_ns)
        self.bins[min(len(self.bins) - 1, (late_ns // 1000).bit_length())] += 1

    def quantile(self, fraction: float) -> float:
        """Upper edge (s) of the bin that holds the given fraction of all wake-ups; 0 if there were none."""
        below, wanted = 0, fraction * self.count
        for exponent, n in enumerate(self.bins):
            below += n
            if n and below >= wanted:
                return float(1 << exponent) * 1e-6
        return 0.0


def request_realtime(priority: int = 20) -> bool:
    """Ask for SCHED_FIFO and 1 us timer slack for the calling thread; False where that is not allowed."""
    try:
        ctypes.CDLL(None).prctl(_PR_SET_TIMERSLACK, 1000, 0, 0, 0)
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(priority))
    except (OSError, AttributeError):
        return False
    return True


class RealtimeExecutor:
    """Runs one node in the calling thread against absolute deadlines on the monotonic clock.

    Args:
        node: what to run.
        clock: the process's clock.
        message_driven: wake the node as soon as `notify` is called, too (needed by nodes that forward).
        realtime: ask for SCHED_FIFO.
    """

    def __init__(
        self, node: Node, clock: SystemClock, *, message_driven: bool = False, realtime: bool = True
    ) -> None:
        self._node = node
        self._clock = clock
        self._message_driven = message_driven
        self._realtime = realtime
        self._condition = threading.Condition()
        self._notified = False
        self._stopping = threading.Event()
        self.lateness = Lateness()
        self.has_realtime_priority = False

    def notify(self) -> None:
        """Wake a message-driven node now; may be called from any thread."""
        with self._condition:
            self._notified = True
            self._condition.notify()

    def stop(self) -> None:
        """Make `run` return soon; may be called from any thread, and from a signal handler."""
        self._stopping.set()

    def run(self) -> None:
        """Step the node until `stop` is called; exceptions of the node pass through."""
        self.has_realtime_priority = self._realtime and request_realtime()
        gc.collect()
        gc.freeze()
        deadline: int | None = self._clock.now_ns()
        while not self._stopping.is_set():
            reached = self._wait(deadline)
            if self._stopping.is_set():
                return
            now_ns = self._clock.now_ns()
            if deadline is not None and reached:
                self.lateness.add(now_ns - deadline)
            deadline = self._node.step(now_ns)

    def _wait(self, deadline: int | None) -> bool:
        """Wait for the deadline or a message; True when the deadline was reached."""
        while not self._stopping.is_set():
            now_ns = self._clock.now_ns()
            if deadline is not None and now_ns >= deadline:
                return True
            limit = now_ns + STOP_CHECK_NS if deadline is None else min(deadline, now_ns + STOP_CHECK_NS)
            if not self._message_driven:
                self._clock.sleep_until(limit)
                continue
            with self._condition:
                if not self._notified:
                    self._condition.wait((limit - now_ns) * 1e-9)
                notified, self._notified = self._notified, False
            if notified:
                return False
        return False
