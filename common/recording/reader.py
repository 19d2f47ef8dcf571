"""Reads recorded runs, also those that were cut off, damaged, or tell of gaps."""

import os
import struct
from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import msgspec
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, McapRecord, Message, Metadata, Schema, Statistics
from mcap.stream_reader import StreamReader, get_chunk_data_stream

from farhand.common.errors import RunFileError
from farhand.common.recording.records import (
    FORMAT,
    GAP,
    PROFILE,
    RUN,
    TICK,
    Gap,
    RunInfo,
    TickRecord,
    unsealed,
)

LARGEST_RECORD = 1 << 28
_RECORD = struct.Struct("<BQ")
"""Opcode and length, before a record."""
_MESSAGE = struct.Struct("<HIQQ")
"""Channel, number, time of log and of publishing, before a message's data."""
HEADER_BYTES = 64
_MARKS = (len(PROFILE).to_bytes(4, "little") + PROFILE.encode(), FORMAT.rpartition("-")[0].encode())
"""Profile and library of an MCAP header, as written by RunFile."""
DAMAGED = "a damaged part of the file was left out"


@dataclass(frozen=True)
class RecordedRun:
    """A run as read.

    Attributes:
        info: see RunInfo.
        ticks: in order, those that are there.
        gaps: where ticks are missing, as the recorder noted or the numbers tell.
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
        return not self.cut_off and not self.gaps and not self.info.first_tick

    @property
    def missing(self) -> int:
        """Ticks that are missing for certain; after a cut nobody knows of how many more."""
        return self.info.first_tick + sum(gap.ticks for gap in self.gaps)

    @property
    def whole_ticks(self) -> int:
        """How many ticks from the run's start on follow on each other without a gap."""
        if self.info.first_tick:
            return 0
        return self.gaps[0].before if self.gaps else len(self.ticks)

    def flaws(self) -> list[str]:
        """A line for people about each gap."""
        lines = [f"{gap.words}{self._since_start(gap)}: {gap.why}" for gap in self.gaps]
        if self.info.first_tick:
            lines.insert(0, f"recording began with tick {self.info.first_tick} of the run")
        return lines

    def _since_start(self, gap: Gap) -> str:
        if not self.ticks:
            return ""
        seconds = (gap.first_ns - self.ticks[0].now_ns) * 1e-9
        return f", {max(0.0, seconds):.1f} s after the start"


@dataclass(frozen=True, slots=True)
class Entry:
    """A message of any topic.

    Attributes:
        topic: its topic.
        log_ns: its time: the time of day, or virtual time (ns).
        data: its bytes.
    """

    topic: str
    log_ns: int
    data: bytes


class RunReader:
    """Reads a recording from its start to its end, or to where it is cut off, a chunk at a time.

    Args:
        path: the file.

    Attributes:
        info: see RunInfo; known once `items` was asked for the first thing.
        cut_off: the file ends early; known at the end.
        damaged: parts that cannot be read and were left out, so far.
        promised: messages of each topic that were written, as the end of the file says; empty: it has none.
        size: bytes of the file.

    Raises:
        RunFileError: it cannot be read, or is no recording of this format.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self.cut_off = False
        self.damaged = 0
        self.promised: dict[str, int] = {}
        try:
            self._file: BinaryIO = path.open("rb")
            self.size = self._file.seek(0, os.SEEK_END)
            self._file.seek(0)
        except OSError as error:
            raise RunFileError(f"run {path}: cannot be read: {error.strerror}") from None
        self._topics: dict[int, str] = {}
        self._records = StreamReader(self._file, emit_chunks=True, record_size_limit=LARGEST_RECORD).records
        self.info = self._find_info()

    def items(self, topics: Callable[[str], bool] = lambda _: True) -> Iterator[Entry | Gap]:
        """Messages of the topics that are wanted, and gaps, in the order of the file."""
        with self._file:
            for record in self._sound():
                if isinstance(record, Chunk):
                    yield from self._messages(record, topics)
                elif isinstance(record, Statistics):
                    counts = record.channel_message_counts.items()
                    self.promised = {self._topics.get(channel, ""): count for channel, count in counts}
                elif isinstance(record, Metadata) and record.name == GAP:
                    gap = _gap(record.metadata)
                    if gap is not None:  # else its ticks' numbers are missing all the same
                        yield gap

    @property
    def topics(self) -> frozenset[str]:
        """All that the file has channels for."""
        return frozenset(self._topics.values())

    def close(self) -> None:
        """Read no more."""
        self._file.close()

    def _find_info(self) -> RunInfo:
        why = "it is empty" if not self.size else "it holds no description of a run"
        try:
            for record in self._records:
                if isinstance(record, Channel):
                    self._topics[record.id] = record.topic
                if isinstance(record, Metadata) and record.name == RUN:
                    return _run_info(record.metadata, self._path)
                if not isinstance(record, (Channel, Schema)) and isinstance(record, (Chunk, Message)):
                    break
        except RunFileError:
            self._file.close()
            raise
        except Exception as error:  # on a cut the reader raises its own, struct.error, EOFError and others
            why = str(error) or why
        ours = self._says_that_it_is_ours()
        self._file.close()
        if ours:
            raise RunFileError(
                f"run {self._path}: a recording of Farhand whose beginning, which says what run it is, is damaged or "
                "cut off: it cannot be read"
            )
        raise RunFileError(f"run {self._path}: not a recording of Farhand: {why}")

    def _says_that_it_is_ours(self) -> bool:
        """By the header's two words, of which a flipped bit leaves one."""
        self._file.seek(0)
        head = self._file.read(HEADER_BYTES)
        return any(mark in head for mark in _MARKS)

    def _sound(self) -> Iterator[McapRecord]:
        """Records, until the end or the cut."""
        try:
            yield from self._records
        except Exception:
            self.cut_off = True

    def _messages(self, chunk: Chunk, topics: Callable[[str], bool]) -> list[Entry]:
        """Those of a chunk that are wanted, all or none."""
        wanted = {number: topic for number, topic in self._topics.items() if topics(topic)}
        try:
            stream, size = get_chunk_data_stream(chunk, validate_crc=True)
            return list(_entries(stream.read(size), wanted))
        except Exception:  # of the decompression, the checksum, or what the bytes then say
            self.damaged += 1
            return []


def _entries(data: bytes, topics: dict[int, str]) -> Iterator[Entry]:
    """Messages of some channels in the records of a chunk; the others, which are most, are not looked at."""
    place = 0
    while place < len(data):
        opcode, length = _RECORD.unpack_from(data, place)
        place += _RECORD.size
        if opcode == Opcode.MESSAGE:
            channel, _, log_ns, _ = _MESSAGE.unpack_from(data, place)
            if channel in topics:
                yield Entry(topics[channel], log_ns, data[place + _MESSAGE.size : place + length])
        place += length


def read_in_order(reader: RunReader, others: Collection[str] = ()) -> Iterator[TickRecord | Gap | Entry]:
    """Ticks, the gaps between and after them as noted or as the numbers tell, and messages of other topics."""
    decode = msgspec.msgpack.Decoder(TickRecord).decode
    expected = reader.info.first_tick
    count = left_out = last_ns = 0
    for item in reader.items(lambda topic: topic == TICK or topic in others):
        if isinstance(item, Gap):
            yield msgspec.structs.replace(item, before=count, after=expected - 1)
            expected += item.ticks
            continue
        if item.topic != TICK:
            yield item
            continue
        try:
            tick = decode(item.data)
        except (msgspec.MsgspecError, ValueError):
            continue  # its number is missing, which is told of
        if tick.number > expected:
            left_out += tick.number - expected
            missing = tick.number - expected
            yield _left_out(missing, last_ns or tick.now_ns, tick.now_ns, count, expected - 1)
        expected, last_ns = tick.number + 1, tick.now_ns
        count += 1
        yield tick
    lost = reader.promised.get(TICK, 0) - count - left_out
    if lost > 0:  # the last ones: no number after them tells
        yield _left_out(lost, last_ns, last_ns, count, expected - 1)


def read_run(path: Path) -> RecordedRun:
    """Read a recording's ticks, also of one that was cut off; raises RunFileError if nothing of it is usable."""
    reader = RunReader(path)
    ticks: list[TickRecord] = []
    gaps: list[Gap] = []
    for item in read_in_order(reader):
        if isinstance(item, TickRecord):
            ticks.append(item)
        elif isinstance(item, Gap):
            gaps.append(item)
    return RecordedRun(reader.info, ticks, tuple(gaps), reader.cut_off, reader.size)


def _left_out(count: int, first_ns: int, last_ns: int, before: int, after: int) -> Gap:
    return Gap(ticks=count, first_ns=first_ns, last_ns=last_ns, why=DAMAGED, before=before, after=after)


def _gap(metadata: dict[str, str]) -> Gap | None:
    try:
        return msgspec.json.decode(unsealed(metadata), type=Gap)
    except ValueError:  # msgspec's are of this kind
        return None


def _run_info(metadata: dict[str, str], path: Path) -> RunInfo:
    """Raises RunFileError where it is of another format, or damaged."""
    try:
        found = msgspec.json.decode(unsealed(metadata))
        form = found.get("format") if isinstance(found, dict) else None
        if form != FORMAT:
            raise RunFileError(
                f"run {path}: has format {form!r}; this program reads {FORMAT}: it was recorded by another version"
            )
        return msgspec.convert(found, RunInfo)
    except ValueError as error:  # msgspec's are of this kind
        raise RunFileError(f"run {path}: its description cannot be read: {error}") from None
