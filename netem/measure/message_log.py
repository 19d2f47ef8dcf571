"""The fate of every message as a CSV file: what was drawn, what was achieved."""

import io
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from farhand.common.errors import InputError
from farhand.netem.impairments.base import Transit

COLUMNS = "direction,key,ordinal,copy,size,arrived_ns,drawn_ns,assigned_ns,achieved_ns,fate"
MAX_ROWS = 20_000_000
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


class CsvLog:
    """Writes a row a message; stops at MAX_ROWS.

    Args:
        path: the file; raises InputError if it cannot be written.
    """

    def __init__(self, path: str | Path) -> None:
        try:
            self._file: io.TextIOWrapper = open(path, "w", buffering=_BUFFER, encoding="utf-8")  # noqa: SIM115
        except OSError as error:
            raise InputError(f"log {path}: cannot be written: {error.strerror}") from None
        self._file.write(COLUMNS + "\n")
        self._origin_ns: int | None = None
        self._rows = 0

    def record(self, direction: str, transit: Transit, released_ns: int | None) -> None:
        """Write one message's row."""
        if self._rows >= MAX_ROWS:
            return
        self._rows += 1
        if self._origin_ns is None:
            self._origin_ns = transit.arrived_ns
        achieved_ns = -1 if released_ns is None else released_ns - transit.arrived_ns
        key = transit.packet.key.replace(",", "_").replace("\n", "_")
        self._file.write(
            f"{direction},{key},{transit.ordinal},{int(transit.is_copy)},{transit.size},"
            f"{transit.arrived_ns - self._origin_ns},{transit.delay_ns},"
            f"{transit.release_ns - transit.arrived_ns},{achieved_ns},{transit.cause or 'delivered'}\n"
        )

    def close(self) -> None:
        """Write the rest."""
        self._file.close()


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
