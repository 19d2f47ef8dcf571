"""The topics of a recording, found by their time: a chunk is read when its time has come, and not kept."""

import io
import struct
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import BinaryIO

import msgspec
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, Message, Metadata, Schema, Statistics
from mcap.stream_reader import breakup_chunk, get_chunk_data_stream
from mcap.writer import MCAP0_MAGIC

from farhand.common.errors import RunFileError
from farhand.common.recording.mcap_file import ChannelSpec
from farhand.common.recording.reader import LARGEST_RECORD, RunReader
from farhand.common.recording.records import GAP, Gap, unsealed

_HEAD = struct.Struct("<BQ")
_SPAN = struct.Struct("<QQ")
Played = tuple[int, int, bytes]
"""Time in the file (ns), number of the channel from 1 on, bytes."""


@dataclass(slots=True)
class ChunkAt:
    """Attributes:
    start, size: where its content is in the file (bytes).
    first_ns, last_ns: time of its messages.
    channels: those that have messages in it, by the file's numbers.
    """

    start: int
    size: int
    first_ns: int
    last_ns: int
    channels: set[int] = field(default_factory=set)


class RecordedTopics:
    """Args:
    path: the recording.

    Attributes:
        info: see RunInfo.
        specs: its channels.
        chunks: in the order of the file.
        cut_off: it ends early.
        missing: ticks that are not in it, as the recorder noted.
        damaged: parts that cannot be read or contradict others, as far as was looked.

    Raises:
        RunFileError: it cannot be read, is no recording, or holds nothing.
    """

    def __init__(self, path: Path) -> None:
        reader = RunReader(path)
        reader.close()
        self.info = reader.info
        self.chunks: list[ChunkAt] = []
        self.cut_off = True
        self.damaged = self.missing = 0
        self._broken: set[int] = set()
        self._checked = 0
        self._numbers: dict[int, int] = {}
        self.specs: tuple[ChannelSpec, ...] = ()
        self._file = path.open("rb")
        try:
            self._look_through()
            if not self.chunks:
                raise RunFileError(f"run {path}: holds no message; expected a recording of a run that began")
        except BaseException:
            self._file.close()
            raise
        self.start_ns = min(chunk.first_ns for chunk in self.chunks)
        self.end_ns = max(chunk.last_ns for chunk in self.chunks)
        self._messages = lru_cache(maxsize=8)(self._read)

    def _look_through(self) -> None:
        """What the file has, and where."""
        schemas: dict[int, Schema] = {}
        specs: list[ChannelSpec] = []
        for opcode, at, size in self._records():
            if opcode == Opcode.CHUNK:
                first_ns, last_ns = _SPAN.unpack(self._bytes(at, _SPAN.size))
                self.chunks.append(ChunkAt(at, size, first_ns, last_ns))
            elif opcode == Opcode.MESSAGE_INDEX and self.chunks:
                self.chunks[-1].channels.add(int.from_bytes(self._bytes(at, 2), "little"))
            elif opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
                self._describe(opcode, self._stream(at, size), schemas, specs)
            elif opcode == Opcode.METADATA:
                self._take_gap(self._stream(at, size))
            elif opcode == Opcode.STATISTICS:
                self._compare(self._stream(at, size))
            elif opcode == Opcode.DATA_END:  # after it the file says again what it holds
                self.cut_off = False
        self.specs = tuple(specs)

    def close(self) -> None:
        """Read no more."""
        self._file.close()

    def _describe(
        self, opcode: int, content: ReadDataStream, schemas: dict[int, Schema], specs: list[ChannelSpec]
    ) -> None:
        """Take a schema or a channel; the end of the file repeats those of its beginning."""
        try:
            if opcode == Opcode.SCHEMA:
                schema = Schema.read(content)
                schemas.setdefault(schema.id, schema)
                return
            channel = Channel.read(content)
            spec = _spec(channel, schemas[channel.schema_id])
            number = self._numbers.setdefault(channel.id, len(specs) + 1)
            if number > len(specs):
                specs.append(spec)
            self.damaged += spec != specs[number - 1]
        except Exception:  # of what the bytes say: lengths, text, a schema that there is not
            self.damaged += 1

    def _take_gap(self, content: ReadDataStream) -> None:
        try:
            record = Metadata.read(content)
            if record.name == GAP:
                self.missing += msgspec.json.decode(unsealed(record.metadata), type=Gap).ticks
        except Exception:  # of what the bytes say
            self.damaged += 1

    def _compare(self, content: ReadDataStream) -> None:
        """The span of the chunks, by which they are found, with that of the messages."""
        try:
            said = Statistics.read(content)
            span = said.message_start_time, said.message_end_time
        except Exception:  # of what the bytes say
            span = None
        self.damaged += bool(self.chunks) and span != (
            min(chunk.first_ns for chunk in self.chunks),
            max(chunk.last_ns for chunk in self.chunks),
        )

    @property
    def lacks(self) -> list[str]:
        """A line about each thing that is missing, as far as was looked."""
        lines = []
        if self.info.first_tick:
            lines.append(f"recording began with tick {self.info.first_tick} of the run")
        if self.cut_off:
            lines.append("the file ends early; what was before the cut is there")
        if self.missing:
            lines.append(f"{self.missing} ticks are missing: they could not be written")
        if self.damaged:
            so_far = "" if self.checked else ", so far"
            lines.append(f"{self.damaged} damaged parts of the file are left out{so_far}")
        return lines

    @property
    def checked(self) -> bool:
        """Whether the whole file was looked through for damage."""
        return self._checked >= len(self.chunks)

    def check(self, most: int) -> None:
        """Look at further chunks for damage, before they are played: at so many."""
        end = min(self._checked + most, len(self.chunks))
        for chunk in range(self._checked, end):
            try:
                get_chunk_data_stream(self._chunk(chunk), validate_crc=True)
            except Exception:  # as in _read
                self._leave_out(chunk)
        self._checked = end

    def number_of(self, topic: str) -> int | None:
        """A channel's number from 1 on; None: there is none."""
        return next((number for number, spec in enumerate(self.specs, 1) if spec.topic == topic), None)

    def messages(self, chunk: int) -> list[Played]:
        """Of a chunk, by time; none where it is damaged."""
        return self._messages(chunk)

    def numbers_in(self, chunk: int) -> frozenset[int]:
        """The channels that have messages in a chunk."""
        return frozenset(self._numbers[each] for each in self.chunks[chunk].channels if each in self._numbers)

    def _read(self, chunk: int) -> list[Played]:
        try:
            records = breakup_chunk(self._chunk(chunk), validate_crc=True)
        except Exception:  # of the decompression, the checksum, or what the bytes then say
            self._leave_out(chunk)
            return []
        found = [
            (record.log_time, self._numbers[record.channel_id], record.data)
            for record in records
            if isinstance(record, Message) and record.channel_id in self._numbers
        ]
        return sorted(found, key=lambda played: played[0])

    def _chunk(self, number: int) -> Chunk:
        at = self.chunks[number]
        chunk: Chunk = Chunk.read(self._stream(at.start, at.size))
        return chunk

    def _leave_out(self, chunk: int) -> None:
        self.damaged += chunk not in self._broken
        self._broken.add(chunk)

    def _records(self) -> Iterator[tuple[int, int, int]]:
        """Opcode, beginning of the content, its size, of each record that is there whole."""
        self._file.seek(0, io.SEEK_END)
        end, at = self._file.tell(), len(MCAP0_MAGIC)
        while at + _HEAD.size <= end:
            opcode, size = _HEAD.unpack(self._bytes(at, _HEAD.size))
            at += _HEAD.size
            if size > min(LARGEST_RECORD, end - at):
                return
            yield opcode, at, size
            at += size

    def _bytes(self, at: int, size: int) -> bytes:
        self._file.seek(at)
        return self._file.read(size)

    def _stream(self, at: int, size: int) -> ReadDataStream:
        stream: BinaryIO = io.BytesIO(self._bytes(at, size))
        return ReadDataStream(stream)


def _spec(channel: Channel, schema: Schema) -> ChannelSpec:
    return ChannelSpec(channel.topic, channel.message_encoding, schema.name, schema.encoding, schema.data)
