"""The fate of every message as a CSV file: what was drawn, what was achieved."""

import io
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from farhand.common.errors import InputError
from farhand.common.recording.fates import Fate
from farhand.common.timing.handoff import Handoff

COLUMNS = "direction,key,ordinal,copy,size,arrived_ns,drawn_ns,assigned_ns,achieved_ns,fate"
MAX_ROWS = 20_000_000
WAITING_ROWS = 1 << 16
_BUFFER = 1 << 20

ROW = np.dtype(
    [
        ("direction", "U8"),
        ("key", "U64"),
        ("ordinal", np.int64),
        ("copy", np.int64),
        ("size", np.int64),
        ("arrived_ns", np.int64),
        ("drawn_ns", np.int64),
        ("assigned_ns", np.int64),
        ("achieved_ns", np.int64),
        ("fate", "U16"),
    ]
)
"""A row: arrival since the first message, the delay drawn by the delay word, the
delay assigned by the whole chain, the delay achieved (-1: dropped), and "delivered" or the cause."""


class CsvLog:
    """Writes a row a message, in a thread of its own; stops at MAX_ROWS.

    Args:
        path: the file; raises InputError if it cannot be begun.

    Attributes:
        missing: rows that are not in the file: they found no place in the queue, or could not be written.
        trouble: why not, in words; empty if none is missing.
    """

    def __init__(self, path: str | Path) -> None:
        self.trouble = ""
        try:
            self._file: io.TextIOWrapper = open(path, "w", encoding="utf-8")  # noqa: SIM115
        except OSError as error:
            raise InputError(f"log {path}: cannot be written: {error.strerror}") from None
        self._taken = 0
        self._unwritten = 0
        self._lines, self._size = [COLUMNS], 0  # not written yet
        self._rows: Handoff[Fate] = Handoff(self._write, "message-log", WAITING_ROWS)

    @property
    def missing(self) -> int:
        """See the class."""
        return self._rows.lost + self._unwritten

    def record(self, fate: Fate) -> None:
        """Hand over one message's row; never waits."""
        if self._taken >= MAX_ROWS:
            return
        self._taken += 1
        if not self._rows.put(fate) and not self.trouble:
            self.trouble = "the disk is too slow"

    def troubles(self) -> dict[str, str]:
        """A line for people about what is missing, by kind of trouble."""
        return {"log": f"--log: {self.missing} rows are missing: {self.trouble}"} if self.missing else {}

    def close(self) -> None:
        """Write the rest; never raises, `missing` and `trouble` tell."""
        self._rows.close()
        self._flush()
        try:
            self._file.close()
        except OSError as error:
            self._fail(error, 1)

    def _write(self, fate: Fate) -> None:
        if self._unwritten:  # a file with a hole in the middle of a row is none
            self._unwritten += 1
            return
        key = fate.key.replace(",", "_").replace("\n", "_")
        times = fate.arrived_ns, fate.drawn_ns, fate.assigned_ns, fate.achieved_ns
        cells = (fate.direction, key, fate.number, int(fate.copy), fate.size, *times, fate.fate)
        self._lines.append(",".join(map(str, cells)))
        self._size += len(self._lines[-1])
        if self._size >= _BUFFER:
            self._flush()

    def _flush(self) -> None:
        """Write what waits; where that fails, all of it counts as missing."""
        lines, self._lines, self._size = self._lines, [], 0
        if not lines or self._unwritten:
            return
        try:
            self._file.write("\n".join(lines) + "\n")
            self._file.flush()
        except OSError as error:
            self._fail(error, len(lines) - (lines[0] == COLUMNS))

    def _fail(self, error: OSError, rows: int) -> None:
        self._unwritten += rows
        self.trouble = f"it cannot be written: {error.strerror or error}"


def read_log(path: str | Path) -> NDArray[np.void]:
    """(n,) rows of ROW, in order of release or drop; raises InputError."""
    try:
        with open(path, encoding="utf-8") as file:
            if file.readline().strip() != COLUMNS:
                raise InputError(f"log {path}: line 1: not a log of netem")
            rows = [tuple(line.rstrip("\n").split(",")) for line in file]
        return np.array(rows, dtype=ROW)
    except (OSError, ValueError) as error:
        raise InputError(f"log {path}: cannot be read: {error}") from None
