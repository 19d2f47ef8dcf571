"""The one loop that every node runs in, against the system clock: step, then its listeners.

Many nodes in one process under a virtual clock are the laboratory's (farhand/laboratory/virtual_executor.py).
"""

import gc
import threading
from collections.abc import Callable

from farhand.common.timing.clock import SystemClock
from farhand.common.timing.lateness import Lateness
from farhand.common.timing.node import Node
from farhand.common.timing.realtime import request_realtime

STOP_CHECK_NS = 50_000_000


class RealtimeLoop:
    """Runs one node in the calling thread against absolute deadlines on the monotonic clock.

    The thread prints nothing, writes no file and answers nobody: what is to be said, written or answered is
    handed to threads of their own (`Handoff`), and what they decide comes back by a `Slot`.

    Args:
        node: what to run.
        clock: the process's clock.
        message_driven: wake the node as soon as `notify` is called, too (needed by nodes that forward).
        realtime: ask for SCHED_FIFO.
        until: the loop ends once this holds of the time (ns); asked after each step, and at least every
            50 ms, also before the first step; must be quick. None: until `stop`.

    Attributes:
        before: called with the time (ns) before each step, such as the serving of a slot.
        after: called with the time (ns) after each step, such as a look at what is new.
        ended_ns: when the loop was found to be at its end; None before.
        lateness: of the wake-ups.
        has_realtime_priority: whether SCHED_FIFO was granted.
    """

    def __init__(
        self,
        node: Node,
        clock: SystemClock,
        *,
        message_driven: bool = False,
        realtime: bool = True,
        until: Callable[[int], bool] | None = None,
    ) -> None:
        self.before: list[Callable[[int], object]] = []
        self.after: list[Callable[[int], object]] = []
        self.ended_ns: int | None = None
        self.lateness = Lateness()
        self.has_realtime_priority = False
        self._node = node
        self._clock = clock
        self._message_driven = message_driven
        self._realtime = realtime
        self._until = until
        self._condition = threading.Condition()
        self._notified = False
        self._stopping = threading.Event()

    def notify(self) -> None:
        """Wake a message-driven node now; may be called from any thread."""
        with self._condition:
            self._notified = True
            self._condition.notify()

    def stop(self) -> None:
        """Make `run` return soon; may be called from any thread, and from a signal handler."""
        self._stopping.set()

    def run(self) -> None:
        """Step the node until the end; exceptions of the node and of its listeners pass through."""
        self.has_realtime_priority = self._realtime and request_realtime()
        gc.collect()
        gc.freeze()
        now_ns = self._clock.now_ns()
        deadline: int | None = now_ns
        while not self._ended(now_ns):
            reached = self._wait(deadline)
            now_ns = self._clock.now_ns()
            if self._ended(now_ns):
                return
            if deadline is not None and reached:
                self.lateness.add(now_ns - deadline)
            for hook in self.before:
                hook(now_ns)
            deadline = self._node.step(now_ns)
            for hook in self.after:
                hook(now_ns)

    def _ended(self, now_ns: int) -> bool:
        if self.ended_ns is None and (
            self._stopping.is_set() or (self._until is not None and self._until(now_ns))
        ):
            self.ended_ns = now_ns
        return self.ended_ns is not None

    def _wait(self, deadline: int | None) -> bool:
        """Wait for the deadline, a message or the end; True when the deadline was reached."""
        while True:
            now_ns = self._clock.now_ns()
            if deadline is not None and now_ns >= deadline:
                return True
            limit = now_ns + STOP_CHECK_NS if deadline is None else min(deadline, now_ns + STOP_CHECK_NS)
            if self._message_driven:
                with self._condition:
                    if not self._notified:
                        self._condition.wait((limit - now_ns) * 1e-9)
                    notified, self._notified = self._notified, False
                if notified:
                    return False
            else:
                self._clock.sleep_until(limit)
            if limit != deadline and self._ended(self._clock.now_ns()):
                return False
