"""Recorded runs: what reached the controller and when, and what it decided, as one MCAP file.

Written by a thread of its own from a queue, and unchunked: a file that was cut off is readable up to the cut.
Topic `tick` holds one MessagePack map per control tick; metadata `run` holds what is needed to run it again.
"""

import io
import queue
import threading
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import msgspec
from mcap.records import Message as McapMessage
from mcap.records import Metadata
from mcap.stream_reader import StreamReader
from mcap.writer import CompressionType, Writer

from farhand.common.errors import RunFileError
from farhand.common.link.link import Packet
from farhand.common.messages.codec import encode
from farhand.common.messages.report import ControlReport

FORMAT = "farhand-run-1"
TOPIC = "tick"


class RunInfo(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What is needed to run the same again.

    Attributes:
        scenario: as TOML-like nested tables.
        robot: the robot's name.
        session: the operator's session.
        seed: the run's seed.
        versions: of the programs and libraries.
        solver: the solver that was really used.
        operator: the operator's name.
    """

    format: str = FORMAT
    scenario: dict[str, object]
    robot: str
    session: int
    seed: int
    versions: dict[str, str]
    solver: str = ""
    operator: str = "operator"


class TickRecord(msgspec.Struct, frozen=True, array_like=True):
    """One tick.

    Attributes:
        now_ns: its beginning, operator's clock.
        packets: (key, arrived_ns, payload) of all that had arrived.
        command: the bytes sent, None if nothing was.
        report: the encoded ControlReport.
    """

    now_ns: int
    packets: tuple[tuple[str, int, bytes], ...]
    command: bytes | None
    report: bytes


class RunRecorder:
    """Writes a run; `tick` never blocks.

    Args:
        path: file to write; its folder must exist.
        info: see RunInfo.
    """

    def __init__(self, path: Path, info: RunInfo) -> None:
        self._stream = path.open("wb")
        self._writer = Writer(self._stream, use_chunking=False, compression=CompressionType.NONE)
        self._writer.start(profile="farhand", library=FORMAT)
        schema = self._writer.register_schema(name="farhand.Tick", encoding="", data=b"")
        self._channel = self._writer.register_channel(
            topic=TOPIC, message_encoding="msgpack", schema_id=schema
        )
        self._writer.add_metadata(name="run", data={"info": msgspec.json.encode(info).decode()})
        self._queue: queue.SimpleQueue[TickRecord | None] = queue.SimpleQueue()
        self._sequence = 0
        self._thread = threading.Thread(target=self._write, name="recorder", daemon=True)
        self._thread.start()

    def tick(self, now_ns: int, packets: list[Packet], command: bytes | None, report: ControlReport) -> None:
        """Queue one tick."""
        copies = tuple((p.key, p.arrived_ns, p.payload) for p in packets)
        self._queue.put(TickRecord(now_ns, copies, command, encode(report)))

    def close(self) -> None:
        """Write what is queued and finish the file."""
        self._queue.put(None)
        self._thread.join()
        self._writer.finish()  # type: ignore[no-untyped-call]
        self._stream.close()

    def _write(self) -> None:
        encoder = msgspec.msgpack.Encoder()
        while (record := self._queue.get()) is not None:
            self._writer.add_message(
                channel_id=self._channel,
                log_time=record.now_ns,
                data=encoder.encode(record),
                publish_time=record.now_ns,
                sequence=self._sequence,
            )
            self._sequence += 1
            if self._queue.empty():
                self._stream.flush()


@dataclass(frozen=True)
class RecordedRun:
    """A run as read.

    Attributes:
        info: see RunInfo.
        ticks: in order.
        complete: False when the file was cut off; `ticks` then holds all before the cut.
        size: bytes of the file.
    """

    info: RunInfo
    ticks: list[TickRecord]
    complete: bool
    size: int


def read_run(path: Path) -> RecordedRun:
    """Read a recording, also one that was cut off; raises RunFileError if nothing of it is usable."""
    try:
        data = path.read_bytes()
    except OSError as error:
        raise RunFileError(f"run {path}: cannot be read: {error.strerror}") from None
    info: RunInfo | None = None
    ticks: list[TickRecord] = []
    decode: Callable[[bytes], TickRecord] = msgspec.msgpack.Decoder(TickRecord).decode
    complete = True
    try:
        for record in StreamReader(io.BytesIO(data)).records:
            if isinstance(record, Metadata) and record.name == "run":
                info = msgspec.json.decode(record.metadata["info"], type=RunInfo)
            elif isinstance(record, McapMessage):
                ticks.append(decode(record.data))
    except Exception as error:  # on a cut the reader raises its own, struct.error, EOFError and others
        complete = False
        if info is None:
            raise RunFileError(f"run {path}: not a recording of Farhand: {error}") from None
    if info is None:
        raise RunFileError(f"run {path}: holds no description of a run; expected {FORMAT}")
    if info.format != FORMAT:
        raise RunFileError(f"run {path}: has format {info.format!r}; this program reads {FORMAT}")
    return RecordedRun(info, ticks, complete, len(data))
