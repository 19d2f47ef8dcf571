"""Recorded runs: whole files, and files whose chunk holds whatever records, with a checksum that fits."""

import io
import zlib
from collections.abc import Callable

import msgspec
from mcap.data_stream import RecordBuilder
from mcap.records import Chunk
from mcap.writer import MCAP0_MAGIC

from farhand.common.errors import InputError
from farhand.common.link.link import Packet
from farhand.common.messages.codec import encode
from farhand.common.messages.keys import state_key
from farhand.common.recording.reader import read_run
from farhand.common.recording.records import RunInfo, TickRecord
from farhand.common.recording.run_file import RunFile
from farhand.report.reading.story import read_story
from farhand.trials.fuzz.files import scratch
from farhand.trials.fuzz.target import Target, one_line
from farhand.trials.fuzz.targets.wire.operator_messages import report, state

INFO = RunInfo(
    scenario={"name": "x", "controller": {"d_min": 0.05, "period": 0.1}}, robot="r", session=7, seed=1, versions={}
)  # fmt: skip
FILE, RECORDS = 0, 1


def seeds() -> list[bytes]:
    """A run of three ticks as a file, and the records of its chunk."""
    path = scratch("seed.mcap")
    file = RunFile(path, INFO)
    for number in range(3):
        packet = Packet(state_key("r"), encode(state(seq=number)), number * 100_000_000)
        taken = ((packet.key, packet.arrived_ns, packet.payload),)
        told = msgspec.structs.replace(report(), tick=number, seq=number)
        file.tick(TickRecord(number, (number + 1) * 100_000_000, taken, None, encode(told)))
    file.close()
    whole = path.read_bytes()
    return [bytes([FILE]) + whole, bytes([RECORDS]) + _records(whole)]


def _records(whole: bytes) -> bytes:
    from mcap.stream_reader import StreamReader, get_chunk_data_stream

    for record in StreamReader(io.BytesIO(whole), emit_chunks=True).records:
        if isinstance(record, Chunk):
            stream, size = get_chunk_data_stream(record, validate_crc=True)
            return bytes(stream.read(size))
    raise AssertionError("the seed has no chunk")


def _head() -> bytes:
    """All that comes before the first chunk of a run."""
    path = scratch("head.mcap")
    RunFile(path, INFO).close()
    whole = path.read_bytes()
    place, kept = len(MCAP0_MAGIC), whole[: len(MCAP0_MAGIC)]
    while place < len(whole):
        opcode, length = whole[place], int.from_bytes(whole[place + 1 : place + 9], "little")
        if opcode == 0x0F:  # the end of the data
            return kept
        kept += whole[place : place + 9 + length]
        place += 9 + length
    raise AssertionError("the seed has no end")


def start() -> Callable[[bytes], None]:
    """See Target."""
    path, head = scratch("run.mcap"), _head()

    def take(data: bytes) -> None:
        content = data[1:]
        if data[:1] == bytes([RECORDS]):
            out = RecordBuilder()
            Chunk(
                compression="", data=content, message_start_time=0, message_end_time=1,
                uncompressed_crc=zlib.crc32(content), uncompressed_size=len(content),
            ).write(out)  # fmt: skip
            content = head + bytes(out.end())  # type: ignore[no-untyped-call]
        path.write_bytes(content)
        try:
            run = read_run(path)
            run.flaws()
            read_story(path)
        except InputError as error:
            one_line(error)

    return take


TARGET = Target(
    edge="recordings (MCAP): files, and records within a chunk whose checksum fits; the report's columns of them",
    promise="a refusal is one line",
    seeds=seeds,
    start=start,
    head=1,
    longest=16_384,
)
