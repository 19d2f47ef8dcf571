"""Writes recorded runs: what reached the controller and when, and what it decided, as one MCAP file.

Written by a thread of its own from a bounded queue, and unchunked: a file that was cut off is readable up to
the cut. What cannot be written leaves a gap that the file tells of, and the run goes on.
"""

from pathlib import Path
from typing import Protocol

import msgspec
from mcap.data_stream import RecordBuilder
from mcap.records import DataEnd, Footer
from mcap.writer import MCAP0_MAGIC, CompressionType, Writer

from farhand.common.errors import RunFileError
from farhand.common.link.link import Packet
from farhand.common.messages.codec import encode
from farhand.common.messages.report import ControlReport
from farhand.common.recording.records import FORMAT, GAP, RUN, TOPIC, Gap, RunInfo, TickRecord
from farhand.common.timing.handoff import Handoff

WAITING_TICKS = 1024
TOO_SLOW = "the disk is too slow: no place in the recorder's queue"


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


class _WholeRecords:
    """A file into which bytes go wholly or not at all."""

    def __init__(self, file: RawFile) -> None:
        self._file = file
        self._size = 0
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
            self._size += len(data)
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
        self._file.truncate(self._size)
        self._file.seek(self._size)
        self._clean = True


class _Stage:
    """Where the writer of MCAP files puts a record, before it goes into the file as a whole."""

    def __init__(self) -> None:
        self._before = 0
        self._bytes = bytearray()

    def write(self, data: bytes) -> int:
        """Take bytes."""
        self._bytes += data
        return len(data)

    def tell(self) -> int:
        """The offset in the file at which the next byte will be."""
        return self._before + len(self._bytes)

    def take(self) -> bytes:
        """Remove and return what is there; it counts as written."""
        data = bytes(self._bytes)
        self._bytes.clear()
        self._before += len(data)
        return data


class RunRecorder:
    """Writes a run.

    Args:
        path: file to write; its folder must exist.
        info: see RunInfo.
        waits: `tick` waits for a place in the queue: right in virtual time, where nothing may be lost to haste.
            Else it never blocks, and what finds no place leaves a gap.
        limit: ticks that may wait.
        file: in place of an unbuffered file at `path`.

    Attributes:
        missing: ticks that are not in the file, so far.
        trouble: why the first of them is not, in words; empty if none is missing.

    Raises:
        RunFileError: the file cannot be begun.
    """

    def __init__(
        self,
        path: Path,
        info: RunInfo,
        *,
        waits: bool = False,
        limit: int = WAITING_TICKS,
        file: RawFile | None = None,
    ) -> None:
        self.missing = 0
        self.trouble = ""
        self._waits = waits
        self._stage = _Stage()
        self._writer = Writer(
            self._stage,  # type: ignore[arg-type]
            use_chunking=False,
            compression=CompressionType.NONE,
        )
        self._writer.start(profile="farhand", library=FORMAT)
        schema = self._writer.register_schema(name="farhand.Tick", encoding="", data=b"")
        self._channel = self._writer.register_channel(
            topic=TOPIC, message_encoding="msgpack", schema_id=schema
        )
        self._writer.add_metadata(name=RUN, data={"info": msgspec.json.encode(info).decode()})
        try:
            self._file = _WholeRecords(path.open("wb", buffering=0) if file is None else file)
            self._file.write(self._stage.take())
        except OSError as error:
            raise RunFileError(f"run {path}: cannot be written: {error.strerror or error}") from None
        self._failed = False
        self._encoder = msgspec.msgpack.Encoder()
        self._sequence = 0
        self._refused: Gap | None = None  # of the loop's thread: found no place, not handed over yet
        self._gap: Gap | None = None  # of the recorder's thread: to be noted before the next tick
        self._ticks: Handoff[tuple[Gap | None, TickRecord | None]] = Handoff(self._take, "recorder", limit)

    def tick(self, now_ns: int, packets: list[Packet], command: bytes | None, report: ControlReport) -> None:
        """Queue one tick."""
        copies = tuple((p.key, p.arrived_ns, p.payload) for p in packets)
        item = self._refused, TickRecord(now_ns, copies, command, encode(report))
        if self._waits:
            self._ticks.put_waiting(item)
        elif self._ticks.put(item):
            self._refused = None
        else:
            self._refused = _joined(self._refused, _one(now_ns, TOO_SLOW))
            self._note(TOO_SLOW)

    def troubles(self) -> dict[str, str]:
        """A line for people about what is missing, by kind of trouble."""
        if not self.missing:
            return {}
        return {
            "recording": f"the recording is not complete, {self.missing} ticks are missing: {self.trouble}"
        }

    def close(self) -> None:
        """Write what is queued and finish the file; never raises, `missing` and `trouble` tell."""
        if self._refused is not None:
            self._ticks.put_waiting((self._refused, None))
        self._ticks.close()
        try:
            self._write_gap()
            self._file.write(self._end())
            self._file.close()
        except OSError as error:
            self.trouble = self.trouble or f"its end cannot be written: {error.strerror or error}"

    def _take(self, item: tuple[Gap | None, TickRecord | None]) -> None:
        gap, record = item
        self._gap = _joined(self._gap, gap)
        if record is None:
            return
        try:
            self._write_gap()
            self._writer.add_message(
                channel_id=self._channel,
                log_time=record.now_ns,
                data=self._encoder.encode(record),
                publish_time=record.now_ns,
                sequence=self._sequence,
            )
            self._file.write(self._stage.take())
            self._sequence += 1
        except OSError as error:
            self._failed = True
            why = f"it cannot be written: {error.strerror or error}"
            self._gap = _joined(self._gap, _one(record.now_ns, why))
            self._note(why)

    def _write_gap(self) -> None:
        if self._gap is not None:
            self._writer.add_metadata(name=GAP, data={"info": msgspec.json.encode(self._gap).decode()})
            self._file.write(self._stage.take())
            self._gap = None

    def _end(self) -> bytes:
        """The end of the file: with an index, unless records failed that the index would count."""
        if self._failed:
            builder = RecordBuilder()
            DataEnd(0).write(builder)
            Footer(0, 0, 0).write(builder)
            end: bytes = builder.end()  # type: ignore[no-untyped-call]
            return end + bytes(MCAP0_MAGIC)
        self._writer.finish()  # type: ignore[no-untyped-call]
        return self._stage.take()

    def _note(self, why: str) -> None:
        self.trouble = self.trouble or why
        self.missing += 1


def _one(now_ns: int, why: str) -> Gap:
    return Gap(ticks=1, first_ns=now_ns, last_ns=now_ns, why=why)


def _joined(first: Gap | None, second: Gap | None) -> Gap | None:
    if first is None or second is None:
        return first or second
    return first.and_then(second)
