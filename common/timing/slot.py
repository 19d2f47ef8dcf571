"""How another thread changes what a real-time thread owns: one place, served between two steps."""

import threading
from collections.abc import Callable
from typing import Generic, TypeVar

from farhand.common.errors import FarhandError

T = TypeVar("T")
PATIENCE = 2.0
"""How long a change waits for the loop (s)."""


class NotServedError(FarhandError):
    """The loop did not take a change in time: it has ended, or hangs."""


class _Change(Generic[T]):
    def __init__(self, make: Callable[[int], T]) -> None:
        self.make = make
        self.claim = threading.Lock()  # either the loop does it, or whoever asked takes it back
        self.done = threading.Event()
        self.result: T | None = None
        self.error: Exception | None = None


class Slot:
    """Holds at most one decided change; whoever wants another one waits outside.

    Args:
        wake: called when a change is there, so that the loop need not come by by itself.
    """

    def __init__(self, wake: Callable[[], None] | None = None) -> None:
        self._wake = wake
        self._turn = threading.Lock()
        self._change: _Change[object] | None = None

    def do(self, change: Callable[[int], T], patience: float = PATIENCE) -> T:
        """Have `change(now_ns)` done in the loop's thread, and what it returned.

        All that takes long must have happened before. Exceptions of the change are raised here.

        Raises:
            NotServedError: after `patience` s; the change is then never done.
        """
        mine: _Change[T] = _Change(change)
        with self._turn:
            self._change = mine  # type: ignore[assignment]
            if self._wake is not None:
                self._wake()
            if not mine.done.wait(patience):
                if mine.claim.acquire(blocking=False):
                    self._change = None
                    raise NotServedError("the program is too busy, or ends; nothing was changed")
                mine.done.wait()
        if mine.error is not None:
            raise mine.error
        return mine.result  # type: ignore[return-value]

    def serve(self, now_ns: int) -> None:
        """Do the change that waits, if any; for the loop's own thread."""
        change = self._change
        if change is None or not change.claim.acquire(blocking=False):
            return
        self._change = None
        try:
            change.result = change.make(now_ns)
        except Exception as error:  # it belongs to whoever asked, not to the loop
            change.error = error
        change.done.set()
