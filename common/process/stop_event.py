"""An event that a signal handler may set while the very same thread waits for it."""

import os
import select
import threading

from farhand.common.timing.clock import SystemClock, to_ns

_MS, _LONGEST_MS = 1_000_000, 1_000_000_000


class StopEvent(threading.Event):
    """A `threading.Event` without a lock.

    The plain one takes a lock in `set` and holds it for a moment in `wait`: a handler that comes in that moment waits
    for its own thread, for ever. This one is a descriptor of the kernel that can be read from once it is set.
    """

    def __init__(self) -> None:
        super().__init__()
        self._descriptor = os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC)
        self._is_set = False
        self._clock = SystemClock()

    def is_set(self) -> bool:
        """Whether it is."""
        return self._is_set

    def set(self) -> None:
        """Set it, from any thread or handler; who waits goes on."""
        self._is_set = True
        os.eventfd_write(self._descriptor, 1)

    def clear(self) -> None:
        """Take it back."""
        self._is_set = False
        try:
            os.eventfd_read(self._descriptor)
        except BlockingIOError:
            pass

    def wait(self, timeout: float | None = None) -> bool:
        """Until it is set, or for `timeout` s; returns whether it is."""
        end_ns = None if timeout is None else self._clock.now_ns() + to_ns(timeout)
        poll = select.poll()  # one for each who waits: it is no thread's but its own
        poll.register(self._descriptor, select.POLLIN)
        while not self._is_set:
            left_ns = None if end_ns is None else end_ns - self._clock.now_ns()
            if left_ns is not None and left_ns <= 0:
                break
            # Whole milliseconds, rounded up: who is woken too early goes round once more.
            poll.poll(None if left_ns is None else min(left_ns // _MS + 1, _LONGEST_MS))
        return self._is_set

    def __del__(self) -> None:
        """Give the descriptor back."""
        try:
            os.close(self._descriptor)
        except (AttributeError, OSError):
            pass
