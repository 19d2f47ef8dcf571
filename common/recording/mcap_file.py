"""An MCAP file that is written chunk by chunk: each goes in whole or not at all, and what is there stays indexed.

The writer of the package `mcap` closes a chunk when it is large; here one is closed when it is old, since a program
that is killed must not lose more than that. The records are the package's own.
"""

import zlib
from collections.abc import Sequence
from dataclasses import dataclass, field

import zstandard
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Channel,
    Chunk,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    Message,
    MessageIndex,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)
from mcap.writer import MCAP0_MAGIC

from farhand.common.recording.whole_records import RawFile, WholeRecords

COMPRESSION, LEVEL = "zstd", 9


@dataclass(frozen=True, slots=True)
class ChannelSpec:
    """Attributes:
    topic: its name.
    encoding: of its messages: `json`, `protobuf`, `msgpack`.
    schema: the name of its schema.
    schema_encoding: of the schema itself: `jsonschema`, `protobuf`; empty: there is none.
    schema_data: the schema.
    """

    topic: str
    encoding: str
    schema: str
    schema_encoding: str = ""
    schema_data: bytes = b""


@dataclass(slots=True)
class _Chunk:
    """Messages that are not in the file yet."""

    builder: RecordBuilder = field(default_factory=RecordBuilder)
    indices: dict[int, MessageIndex] = field(default_factory=dict)
    first_ns: int = 0
    last_ns: int = 0
    count: int = 0

    def add(self, message: Message) -> None:
        at = message.log_time
        self.first_ns = min(self.first_ns, at) if self.count else at
        self.last_ns = max(self.last_ns, at)
        self.count += 1
        index = self.indices.setdefault(message.channel_id, MessageIndex(message.channel_id, []))
        index.records.append((at, self.builder.count))
        message.write(self.builder)


class McapFile:
    """Args:
    file: written to by nobody else.
    profile, library: of the header.
    channels: all that there will be, ids from 1 on in this order.

    Raises:
        OSError: its beginning cannot be written.
    """

    def __init__(self, file: RawFile, profile: str, library: str, channels: tuple[ChannelSpec, ...]) -> None:
        self._file = WholeRecords(file)
        self._compress = zstandard.ZstdCompressor(level=LEVEL)
        self._chunk = _Chunk()
        self._schemas, self._channels = _numbered(channels)
        self._chunks: list[ChunkIndex] = []
        self._metadata: list[MetadataIndex] = []
        self._counts: dict[int, int] = {}
        self._span: tuple[int, int] | None = None
        begin = RecordBuilder()
        Header(profile=profile, library=library).write(begin)
        for each in (*self._schemas, *self._channels):
            each.write(begin)
        self._file.write(bytes(MCAP0_MAGIC) + _taken(begin))

    def add(self, channel: int, log_ns: int, data: bytes, sequence: int = 0) -> None:
        """Put a message into the open chunk (ns of the file's own time)."""
        self._chunk.add(
            Message(channel_id=channel, log_time=log_ns, data=data, publish_time=log_ns, sequence=sequence)
        )

    @property
    def waiting(self) -> int:
        """Bytes in the open chunk."""
        count: int = self._chunk.builder.count
        return count

    def flush(self) -> None:
        """Close the chunk; raises OSError, and then its messages are lost and the file is as before."""
        chunk, self._chunk = self._chunk, _Chunk()
        if not chunk.count:
            return
        raw = _taken(chunk.builder)
        packed = self._compress.compress(raw)
        out = RecordBuilder()
        Chunk(
            compression=COMPRESSION,
            data=packed,
            message_start_time=chunk.first_ns,
            message_end_time=chunk.last_ns,
            uncompressed_crc=zlib.crc32(raw),
            uncompressed_size=len(raw),
        ).write(out)
        start, length = self._file.size, out.count
        offsets = {}
        for number, index in chunk.indices.items():
            offsets[number] = start + out.count
            index.write(out)
        whole = _taken(out)
        self._file.write(whole)
        self._chunks.append(
            ChunkIndex(
                chunk_length=length,
                chunk_start_offset=start,
                compression=COMPRESSION,
                compressed_size=len(packed),
                message_start_time=chunk.first_ns,
                message_end_time=chunk.last_ns,
                message_index_length=len(whole) - length,
                message_index_offsets=offsets,
                uncompressed_size=len(raw),
            )
        )
        for number, index in chunk.indices.items():
            self._counts[number] = self._counts.get(number, 0) + len(index.records)
        first, last = self._span or (chunk.first_ns, chunk.last_ns)
        self._span = min(first, chunk.first_ns), max(last, chunk.last_ns)

    def discard(self) -> None:
        """Forget the open chunk."""
        self._chunk = _Chunk()

    def metadata(self, name: str, data: dict[str, str]) -> None:
        """Write a record of metadata, before the open chunk; raises OSError."""
        out = RecordBuilder()
        Metadata(name=name, metadata=data).write(out)
        start, whole = self._file.size, _taken(out)
        self._file.write(whole)
        self._metadata.append(MetadataIndex(offset=start, length=len(whole), name=name))

    def close(self) -> None:
        """Write the open chunk, and the summary by which a reader finds everything; raises OSError."""
        try:
            self.flush()
            self._file.write(self._end())
        finally:
            self._file.close()

    def _end(self) -> bytes:
        out = RecordBuilder()
        DataEnd(0).write(out)
        before = self._file.size + out.count
        summary = RecordBuilder()
        offsets = [
            _group(summary, opcode, records, before)
            for opcode, records in (
                (Opcode.SCHEMA, self._schemas),
                (Opcode.CHANNEL, self._channels),
                (Opcode.STATISTICS, [self._statistics()]),
                (Opcode.CHUNK_INDEX, self._chunks),
                (Opcode.METADATA_INDEX, self._metadata),
            )
            if records
        ]
        offsets_start = before + summary.count
        for offset in offsets:
            offset.write(summary)
        data = _taken(summary)
        foot = RecordBuilder()
        Footer(summary_start=before, summary_offset_start=offsets_start, summary_crc=0).write(foot)
        unchecked = _taken(foot)  # the checksum covers all of the footer but itself
        check = zlib.crc32(unchecked[:-4], zlib.crc32(data))
        return _taken(out) + data + unchecked[:-4] + check.to_bytes(4, "little") + bytes(MCAP0_MAGIC)

    def _statistics(self) -> Statistics:
        first, last = self._span or (0, 0)
        return Statistics(
            attachment_count=0,
            channel_count=len(self._channels),
            channel_message_counts=self._counts,
            chunk_count=len(self._chunks),
            message_count=sum(self._counts.values()),
            metadata_count=len(self._metadata),
            message_start_time=first,
            message_end_time=last,
            schema_count=len(self._schemas),
        )


def _numbered(channels: tuple[ChannelSpec, ...]) -> tuple[list[Schema], list[Channel]]:
    schemas: dict[str, Schema] = {}
    numbered = []
    for number, each in enumerate(channels, 1):
        schema = schemas.setdefault(
            each.schema,
            Schema(
                id=len(schemas) + 1, name=each.schema, encoding=each.schema_encoding, data=each.schema_data
            ),
        )
        numbered.append(
            Channel(
                id=number,
                topic=each.topic,
                message_encoding=each.encoding,
                schema_id=schema.id,
                metadata={},
            )
        )
    return list(schemas.values()), numbered


def _group(out: RecordBuilder, opcode: int, records: Sequence[McapRecord], before: int) -> SummaryOffset:
    start = out.count
    for record in records:
        record.write(out)
    return SummaryOffset(group_opcode=opcode, group_start=before + start, group_length=out.count - start)


def _taken(builder: RecordBuilder) -> bytes:
    data: bytes = builder.end()  # type: ignore[no-untyped-call]
    return data
