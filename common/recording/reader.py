"""Reads recorded runs, also those that were cut off or tell of gaps."""

import io
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import msgspec
from mcap.records import Message as McapMessage
from mcap.records import Metadata
from mcap.stream_reader import StreamReader

from farhand.common.errors import RunFileError
from farhand.common.recording.records import FORMAT, GAP, RUN, Gap, RunInfo, TickRecord


@dataclass(frozen=True)
class RecordedRun:
    """A run as read.

    Attributes:
        info: see RunInfo.
        ticks: in order, those that are there.
        gaps: where ticks are missing, as the recorder noted.
        cut_off: the file ends early; `ticks` then holds all before the cut.
        size: bytes of the file.
    """

    info: RunInfo
    ticks: list[TickRecord]
    gaps: tuple[Gap, ...]
    cut_off: bool
    size: int

    @property
    def complete(self) -> bool:
        """Whether every tick of the run is there."""
        return not self.cut_off and not self.gaps

    @property
    def missing(self) -> int:
        """Ticks that are missing for certain; after a cut nobody knows of how many more."""
        return sum(gap.ticks for gap in self.gaps)

    @property
    def whole_ticks(self) -> int:
        """How many ticks from the start on follow on each other without a gap."""
        return self.gaps[0].before if self.gaps else len(self.ticks)

    def flaws(self) -> list[str]:
        """A line for people about each gap."""
        lines = [
            f"{gap.ticks} ticks are missing after tick {gap.before}{self._since_start(gap)}: {gap.why}"
            for gap in self.gaps
        ]
        return lines

    def _since_start(self, gap: Gap) -> str:
        if not self.ticks:
            return ""
        seconds = (gap.first_ns - self.ticks[0].now_ns) * 1e-9
        return f", {max(0.0, seconds):.1f} s after the start"


def read_run(path: Path) -> RecordedRun:
    """Read a recording, also one that was cut off; raises RunFileError if nothing of it is usable."""
    try:
        data = path.read_bytes()
    except OSError as error:
        raise RunFileError(f"run {path}: cannot be read: {error.strerror}") from None
    info: RunInfo | None = None
    ticks: list[TickRecord] = []
    gaps: list[Gap] = []
    decode: Callable[[bytes], TickRecord] = msgspec.msgpack.Decoder(TickRecord).decode
    cut_off = False
    try:
        for record in StreamReader(io.BytesIO(data)).records:
            if isinstance(record, McapMessage):
                ticks.append(decode(record.data))
            elif isinstance(record, Metadata) and record.name == RUN:
                info = msgspec.json.decode(record.metadata["info"], type=RunInfo)
            elif isinstance(record, Metadata) and record.name == GAP:
                gap = msgspec.json.decode(record.metadata["info"], type=Gap)
                gaps.append(msgspec.structs.replace(gap, before=len(ticks)))
    except Exception as error:  # on a cut the reader raises its own, struct.error, EOFError and others
        cut_off = True
        if info is None:
            what = str(error) or "it is empty"
            raise RunFileError(f"run {path}: not a recording of Farhand: {what}") from None
    if info is None:
        raise RunFileError(f"run {path}: holds no description of a run; expected {FORMAT}")
    if info.format != FORMAT:
        raise RunFileError(
            f"run {path}: has format {info.format!r}; this program reads {FORMAT}: it was recorded by another version"
        )
    return RecordedRun(info, ticks, tuple(gaps), cut_off, len(data))
