"""The newest things of a kind, numbered, kept by a real-time thread for whoever comes for them: it waits for nobody."""

from collections import deque
from collections.abc import Callable, Sequence
from itertools import islice
from typing import Generic, TypeVar

T = TypeVar("T")


class History(Generic[T]):
    """Args:
    kept: how many things.
    """

    def __init__(self, kept: int) -> None:
        self._things: deque[tuple[int, T]] = deque(maxlen=kept)
        self.count = 0

    def add(self, thing: T) -> None:
        """Keep one; for the thread that makes them."""
        self._things.append((self.count, thing))
        self.count += 1

    def since(self, number: int, size: int, size_of: Callable[[T], int]) -> tuple[int, Sequence[T], int]:
        """Things from a number on, the oldest first, until they have so many bytes; for any thread.

        Returns the number of the first (a higher one than asked for, where that is kept no more), the things, and how
        many there were in all when it looked.
        """
        count, things = self._look()
        first = max(number, things[0][0]) if things else number
        found: list[T] = []
        for _, thing in islice(things, first - things[0][0] if things else 0, None):
            found.append(thing)
            size -= size_of(thing)
            if size <= 0:
                break
        return (first if found else number), found, count

    def _look(self) -> tuple[int, list[tuple[int, T]]]:
        while True:
            try:
                things = list(self._things)
            except RuntimeError:  # one was added at that very moment
                continue
            return things[-1][0] + 1 if things else self.count, things
