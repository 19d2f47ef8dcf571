"""A run's file: ticks as they were and what views say of them; what cannot be written leaves a gap that it tells of."""

import fcntl
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Protocol

import msgspec

from farhand.common.errors import RunFileError
from farhand.common.messages.camera import CameraFrame
from farhand.common.recording.decoded import TickDecoder
from farhand.common.recording.fates import FATE_TOPICS, Fate
from farhand.common.recording.json_view import JsonView, View, json_channel
from farhand.common.recording.mcap_file import ChannelSpec, McapFile
from farhand.common.recording.records import FORMAT, GAP, PROFILE, RUN, TICK, Gap, RunInfo, TickRecord, sealed
from farhand.common.recording.whole_records import RawFile

CHUNK_BYTES = 1 << 19
CHUNK_NS = 500_000_000
"""A chunk is closed when it holds so much, or spans so long: what is lost to a kill."""
_TICK = ChannelSpec(TICK, "msgpack", "farhand.Tick")
_FATES = tuple(json_channel(topic, Fate) for topic in FATE_TOPICS.values())


class Messages(Protocol):
    """What a run's messages go into; see McapFile."""

    @property
    def waiting(self) -> int:
        """Bytes that are not written yet."""
        ...

    def add(self, channel: int, log_ns: int, data: bytes, sequence: int = 0) -> None:
        """Take a message."""
        ...

    def metadata(self, name: str, data: dict[str, str]) -> None:
        """Take a record of metadata."""
        ...

    def flush(self) -> None:
        """Write what waits."""
        ...

    def discard(self) -> None:
        """Forget what waits."""
        ...

    def close(self) -> None:
        """Write the end."""
        ...


class RunFile:
    """Writes a run. None of its methods raises for want of disk; `missing` and `trouble` tell.

    Args:
        path: file to write; its folder must exist.
        info: see RunInfo.
        views: what is told beside the ticks' bytes.
        file: in place of an unbuffered file at `path`.
        into: makes what takes the messages in place of an MCAP file, from the channels that there will be.

    Attributes:
        missing: ticks that are not in the file, so far.
        missing_fates: messages of whose fates the same is true, for want of disk.
        trouble: why the first of them is not, in words; empty if none is missing.

    Raises:
        RunFileError: the file cannot be begun.
    """

    def __init__(
        self,
        path: Path,
        info: RunInfo,
        views: Sequence[View] = (),
        file: RawFile | None = None,
        into: Callable[[tuple[ChannelSpec, ...]], Messages] | None = None,
    ) -> None:
        self.missing, self.missing_fates, self.trouble = 0, 0, ""
        self._views = (JsonView(), *views)
        self._epoch_ns = info.epoch_ns
        self._decoder, self._encode = TickDecoder(), msgspec.msgpack.Encoder().encode
        self._encode_fate = msgspec.json.Encoder().encode
        channels = (_TICK, *_FATES, *(each for view in self._views for each in view.channels))
        self._numbers = {each.topic: number for number, each in enumerate(channels, 1)}
        self._open: list[int] = []  # the beginnings of the ticks in the open chunk
        self._open_fates = 0
        self._gap: Gap | None = None  # to be noted before the next chunk
        try:
            self._file: Messages = (
                into(channels)
                if into is not None
                else McapFile(_opened(path) if file is None else file, PROFILE, FORMAT, channels)
            )
            self._file.metadata(RUN, sealed(info))
        except OSError as error:
            raise RunFileError(f"run {path}: cannot be written: {error.strerror or error}") from None

    def tick(self, record: TickRecord) -> None:
        """Take a tick; written when its chunk is closed."""
        decoded = self._decoder.decode(record)
        self._put(TICK, record.now_ns, self._encode(record), record.number)
        for view in self._views:
            for topic, stamp_ns, data in view.tick(decoded):
                self._put(topic, stamp_ns, data, record.number)
        self._open.append(record.now_ns)
        if self._file.waiting > CHUNK_BYTES or record.now_ns - self._open[0] >= CHUNK_NS:
            self.flush()

    def fate(self, fate: Fate, epoch_ns: int) -> None:
        """Take what became of a message at the emulator.

        Args:
            fate: of one message.
            epoch_ns: what must be added to `arrived_ns` for the file's time (ns).
        """
        number = self._numbers[FATE_TOPICS[fate.direction]]
        self._open_fates += 1
        self._file.add(number, fate.arrived_ns + epoch_ns, self._encode_fate(fate), fate.number)

    def frame(self, frame: CameraFrame, time_ns: int) -> None:
        """Take a picture that came at a time of day (ns since 1970); views alone tell of it."""
        for view in self._views:
            for topic, stamp_ns, data in view.frame(frame, time_ns - self._epoch_ns):
                self._put(topic, stamp_ns, data, frame.seq & 0xFFFFFFFF)

    def gap(self, gap: Gap) -> None:
        """Ticks that came never."""
        self.flush()
        self._miss(gap)

    def flush(self) -> None:
        """Write what waits."""
        if not self._open:
            return
        opened, self._open = self._open, []
        try:
            self._write_gap()
            self._file.flush()
            self._open_fates = 0
        except OSError as error:
            self._discard()
            why = f"it cannot be written: {error.strerror or error}"
            self._miss(Gap(ticks=len(opened), first_ns=opened[0], last_ns=opened[-1], why=why))

    def close(self) -> None:
        """Write what waits and finish the file."""
        self.flush()
        try:
            self._write_gap()
        except OSError:
            pass  # the end, which is tried next, says the same
        try:
            self._file.flush()  # what came after the last tick
        except OSError:
            self._discard()
        try:
            self._file.close()
        except OSError as error:
            self.trouble = self.trouble or f"its end cannot be written: {error.strerror or error}"

    def _discard(self) -> None:
        self._file.discard()
        self.missing_fates += self._open_fates
        self._open_fates = 0

    def _put(self, topic: str, stamp_ns: int, data: bytes, sequence: int) -> None:
        self._file.add(self._numbers[topic], stamp_ns + self._epoch_ns, data, sequence)

    def _miss(self, gap: Gap) -> None:
        self.trouble = self.trouble or gap.why
        self.missing += gap.ticks
        self._gap = gap if self._gap is None else self._gap.and_then(gap)

    def _write_gap(self) -> None:
        if self._gap is not None:
            self._file.metadata(GAP, sealed(self._gap))
            self._gap = None


def _opened(path: Path) -> RawFile:
    """The file, with the kernel's lock by which others know that it is being written, as long as this process lives."""
    file = path.open("wb", buffering=0)
    with suppress(OSError):  # of a file system that has none
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    return file
