"""What observers on the hosts print, stamped on arrival."""

import bisect
import json
import threading
from collections.abc import Mapping
from typing import IO, Any

from farhand.common.timing.clock import SystemClock

Row = Mapping[str, Any]


class Watcher:
    """Reads an observer's lines in a thread and stamps their arrival.

    Args:
        pipe: the observer's standard output.
        clock: of this process.
    """

    def __init__(self, pipe: IO[str], clock: SystemClock) -> None:
        self.rows: list[tuple[int, Row]] = []
        self._clock = clock
        threading.Thread(target=self._read, args=(pipe,), daemon=True).start()

    def since(self, start_ns: int) -> list[tuple[int, Row]]:
        """Rows that arrived at `start_ns` or later."""
        rows = self.rows
        return rows[bisect.bisect_left(rows, start_ns, key=lambda row: row[0]) :]

    def _read(self, pipe: IO[str]) -> None:
        try:
            for line in pipe:
                self.rows.append((self._clock.now_ns(), json.loads(line)))
        except ValueError:
            return  # closed at the end
