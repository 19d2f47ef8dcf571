"""A file for a recorder to write to, that is slow, full or broken whenever a test wants it to be."""

import errno
import io
import threading
from collections.abc import Callable


class ScriptedFile:
    """An unbuffered file in memory, which now and then takes a part of the bytes only, as real ones may.

    Args:
        fails: told the number of each write, from 1 on; whether it fails with "no space left", after having
            left half of its bytes.

    Attributes:
        data: what is in the file.
        writes: how many there were.
        threads: names of the threads that wrote.
        held: while it is not None, a write waits for this event (at most 10 s).
    """

    def __init__(self, fails: Callable[[int], bool] = lambda number: False) -> None:
        self.data = bytearray()
        self.writes = 0
        self.threads: set[str] = set()
        self.fails = fails
        self.held: threading.Event | None = None
        self._place = 0

    def write(self, data: bytes, /) -> int:
        """Write all but the last three bytes; raises OSError where it shall fail."""
        self.writes += 1
        self.threads.add(threading.current_thread().name)
        if self.held is not None:
            assert self.held.wait(10)
        if self.fails(self.writes):
            self._put(data[: len(data) // 2])
            raise OSError(errno.ENOSPC, "No space left on device")
        count = max(1, len(data) - 3)
        self._put(data[:count])
        return count

    def seek(self, offset: int, /) -> int:
        """Go to an offset."""
        self._place = offset
        return offset

    def truncate(self, size: int, /) -> int:
        """Cut the file off."""
        del self.data[size:]
        return size

    def close(self) -> None:
        """Nothing to do."""

    def read_bytes(self) -> bytes:
        """All of it, as of a path."""
        return bytes(self.data)

    def open(self, mode: str) -> io.BytesIO:
        """To be read, as of a path."""
        return io.BytesIO(self.read_bytes())

    def _put(self, data: bytes) -> None:
        self.data[self._place : self._place + len(data)] = data
        self._place += len(data)
