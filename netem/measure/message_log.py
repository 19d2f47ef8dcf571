"""The fate of every message as a CSV file: what was drawn, what was achieved."""

import io
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from farhand.common.errors import InputError
from farhand.common.timing.handoff import Handoff
from farhand.netem.impairments.base import Transit

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
"""A row: arrival on the emulator's clock since the first row's, the delay drawn by the delay word, the
delay assigned by the whole chain, the delay achieved (-1: dropped), and "delivered" or the cause."""


_Row = tuple[str, str, int, bool, int, int, int, int, int, str]


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
        self._origin_ns: int | None = None
        self._taken = 0
        self._unwritten = 0
        self._lines, self._size = [COLUMNS], 0  # not written yet
        self._rows: Handoff[_Row] = Handoff(self._write, "message-log", WAITING_ROWS)

    @property
    def missing(self) -> int:
        """See the class."""
        return self._rows.lost + self._unwritten

    def record(self, direction: str, transit: Transit, released_ns: int | None) -> None:
        """Hand over one message's row; never waits."""
        if self._taken >= MAX_ROWS:
            return
        self._taken += 1
        if self._origin_ns is None:
            self._origin_ns = transit.arrived_ns
        placed = self._rows.put(
            (
                direction,
                transit.packet.key,
                transit.ordinal,
                transit.is_copy,
                transit.size,
                transit.arrived_ns - self._origin_ns,
                transit.delay_ns,
                transit.release_ns - transit.arrived_ns,
                -1 if released_ns is None else released_ns - transit.arrived_ns,
                transit.cause or "delivered",
            )
        )
        if not placed and not self.trouble:
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

    def _write(self, row: _Row) -> None:
        direction, key, ordinal, is_copy, *rest = row
        if self._unwritten:  # a file with a hole in the middle of a row is none
            self._unwritten += 1
            return
        key = key.replace(",", "_").replace("\n", "_")
        cells = (direction, key, ordinal, int(is_copy), *rest)
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
