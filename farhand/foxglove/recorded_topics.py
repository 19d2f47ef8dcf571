"""The topics of a recording, found by their time: a chunk is read when its time has come, and not kept."""

import io
import struct
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import BinaryIO

from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, Message, Schema
from mcap.stream_reader import breakup_chunk
from mcap.writer import MCAP0_MAGIC

from farhand.common.errors import RunFileError
from farhand.common.recording.mcap_file import ChannelSpec
from farhand.common.recording.reader import LARGEST_RECORD, RunReader

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

    Raises:
        RunFileError: it cannot be read, is no recording, or holds nothing.
    """

    def __init__(self, path: Path) -> None:
        reader = RunReader(path)
        reader.close()
        self.info = reader.info
        self.chunks: list[ChunkAt] = []
        self.cut_off = True
        self._numbers: dict[int, int] = {}
        specs: list[ChannelSpec] = []
        self._file = path.open("rb")
        schemas: dict[int, Schema] = {}
        for opcode, at, size in self._records():
            if opcode == Opcode.CHUNK:
                first_ns, last_ns = _SPAN.unpack(self._bytes(at, _SPAN.size))
                self.chunks.append(ChunkAt(at, size, first_ns, last_ns))
            elif opcode == Opcode.MESSAGE_INDEX and self.chunks:
                self.chunks[-1].channels.add(int.from_bytes(self._bytes(at, 2), "little"))
            elif opcode == Opcode.SCHEMA:
                schema = Schema.read(self._stream(at, size))
                schemas[schema.id] = schema
            elif opcode == Opcode.CHANNEL:
                channel = Channel.read(self._stream(at, size))
                if channel.id not in self._numbers and channel.schema_id in schemas:
                    self._numbers[channel.id] = len(specs) + 1
                    specs.append(_spec(channel, schemas[channel.schema_id]))
            elif opcode == Opcode.DATA_END:
                self.cut_off = False
                break
        self.specs = tuple(specs)
        if not self.chunks:
            raise RunFileError(f"run {path}: holds no message; expected a recording of a run that began")
        self.start_ns = min(chunk.first_ns for chunk in self.chunks)
        self.end_ns = max(chunk.last_ns for chunk in self.chunks)
        self._messages = lru_cache(maxsize=8)(self._read)

    def close(self) -> None:
        """Read no more."""
        self._file.close()

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
        at = self.chunks[chunk]
        try:
            records = breakup_chunk(Chunk.read(self._stream(at.start, at.size)), validate_crc=True)
        except Exception:  # of the decompression, the checksum, or what the bytes then say
            return []
        found = [
            (record.log_time, self._numbers[record.channel_id], record.data)
            for record in records
            if isinstance(record, Message) and record.channel_id in self._numbers
        ]
        return sorted(found, key=lambda played: played[0])

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
