"""A file into which bytes go wholly or not at all, so that a full disk leaves nothing half written behind."""

from typing import Protocol


class RawFile(Protocol):
    """The unbuffered file that is written to."""

    def write(self, data: bytes, /) -> int | None:
        """Write some of the bytes; how many."""
        ...

    def seek(self, offset: int, /) -> int:
        """Go to an offset."""
        ...

    def truncate(self, size: int, /) -> int:
        """Cut the file off."""
        ...

    def close(self) -> None:
        """Close it."""
        ...


class WholeRecords:
    """Args:
    file: written to by nobody else.

    Attributes:
        size: bytes that are in it.
    """

    def __init__(self, file: RawFile) -> None:
        self.size = 0
        self._file = file
        self._clean = True

    def write(self, data: bytes) -> None:
        """Raises OSError, and then has left nothing that stays."""
        try:
            if not self._clean:  # the last attempt left a part, and could not take it back
                self._take_back()
            view, done = memoryview(data), 0
            while done < len(data):
                self._clean = False
                done += self._file.write(view[done:]) or 0  # type: ignore[arg-type]
            self.size += len(data)
            self._clean = True
        except OSError:
            try:
                self._take_back()
            except OSError:
                pass  # tried again before the next record
            raise

    def close(self) -> None:
        """Raises OSError where the last bytes did not arrive."""
        self._file.close()

    def _take_back(self) -> None:
        self._file.truncate(self.size)
        self._file.seek(self.size)
        self._clean = True
