"""What a real-time thread hands to a thread of its own: lines to say, rows and ticks to write."""

import queue
import threading
from collections.abc import Callable
from typing import Generic, TypeVar

T = TypeVar("T")
ROOM_CHECK = 0.001


class Handoff(Generic[T]):
    """A bounded queue and the thread that works it off, in order.

    Args:
        work: does one thing, in the thread; must not raise.
        name: of the thread.
        limit: how many things may wait.
        idle: called in the thread whenever nothing waits any more, and at the end, such as a flush.

    Attributes:
        lost: how many things found no place.
    """

    def __init__(
        self,
        work: Callable[[T], None],
        name: str,
        limit: int,
        idle: Callable[[], None] | None = None,
    ) -> None:
        if limit <= 0:
            raise ValueError("a queue holds one thing at least")
        self.lost = 0
        self._work, self._idle, self._limit = work, idle, limit
        # A SimpleQueue has no lock that the thread could hold while the loop wants it.
        self._queue: queue.SimpleQueue[tuple[T] | None] = queue.SimpleQueue()
        self._pause = threading.Event()
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)
        self._thread.start()

    def put(self, item: T) -> bool:
        """Hand one thing over without ever waiting; False, and counted, where there is no place."""
        if self._queue.qsize() >= self._limit:
            self.lost += 1
            return False
        self._queue.put((item,))
        return True

    def put_waiting(self, item: T) -> None:
        """Hand one thing over as soon as there is a place: for virtual time, which can wait."""
        while self._queue.qsize() >= self._limit:
            self._pause.wait(ROOM_CHECK)
        self._queue.put((item,))

    def close(self, patience: float | None = None) -> bool:
        """Work off what waits, for at most `patience` s (None: to the end); whether all of it is done."""
        self._queue.put(None)
        self._thread.join(patience)
        return not self._thread.is_alive()

    def _run(self) -> None:
        while (found := self._queue.get()) is not None:
            self._work(found[0])
            if self._idle is not None and self._queue.empty():
                self._idle()
        if self._idle is not None:
            self._idle()
