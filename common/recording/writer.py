"""Records a run from within its own process: for virtual time, where the run can wait for the disk."""

from collections.abc import Sequence
from pathlib import Path

from farhand.common.link.link import Packet
from farhand.common.messages.codec import encode
from farhand.common.messages.report import ControlReport
from farhand.common.recording.fates import Fate
from farhand.common.recording.json_view import View
from farhand.common.recording.records import RunInfo, TickRecord
from farhand.common.recording.run_file import RunFile
from farhand.common.recording.whole_records import RawFile
from farhand.common.timing.handoff import Handoff

WAITING_TICKS = 1024


class RunRecorder:
    """Hands each tick to a thread that writes it; waits where that one is behind.

    Args: see RunFile.

    Attributes:
        missing, trouble: see RunFile.

    Raises:
        RunFileError: the file cannot be begun.
    """

    def __init__(
        self, path: Path, info: RunInfo, views: Sequence[View] = (), file: RawFile | None = None
    ) -> None:
        self._file = RunFile(path, info, views, file)
        self._number = 0
        self._items: Handoff[TickRecord | tuple[Fate, int]] = Handoff(self._take, "recorder", WAITING_TICKS)

    @property
    def missing(self) -> int:
        """See the class."""
        return self._file.missing

    @property
    def trouble(self) -> str:
        """See the class."""
        return self._file.trouble

    def tick(self, now_ns: int, packets: list[Packet], command: bytes | None, report: ControlReport) -> None:
        """Hand one tick over."""
        copies = tuple((p.key, p.arrived_ns, p.payload) for p in packets)
        self._items.put_waiting(TickRecord(self._number, now_ns, copies, command, encode(report)))
        self._number += 1

    def fate(self, fate: Fate, epoch_ns: int) -> None:
        """Hand over what became of a message at the emulator; see RunFile."""
        self._items.put_waiting((fate, epoch_ns))

    def _take(self, item: TickRecord | tuple[Fate, int]) -> None:
        if isinstance(item, TickRecord):
            self._file.tick(item)
        else:
            self._file.fate(*item)

    def close(self) -> None:
        """Write what is handed over and finish the file; never raises, `missing` and `trouble` tell."""
        self._items.close()
        self._file.close()
