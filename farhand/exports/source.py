"""A recording, read once from its start to its end, for whoever writes it in another form."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import msgspec

from farhand.common.recording.decoded import DecodedTick, TickDecoder
from farhand.common.recording.fates import FATE_TOPICS, Fate
from farhand.common.recording.place import recording_at
from farhand.common.recording.reader import DAMAGED, Entry, RunReader
from farhand.common.recording.records import TICK, Gap, RunInfo, TickRecord
from farhand.exports.images import Image, image_of
from farhand.runs.files import RECORDING

CAMERA = "/camera"
_FATE_TOPICS = frozenset(FATE_TOPICS.values())
Item = DecodedTick | Gap | Fate | Image


@dataclass(frozen=True, slots=True)
class Run:
    """Attributes:
    name: for people and tables: of its folder, or of its file.
    path: its file.
    """

    name: str
    path: Path


def run_at(path: Path) -> Run:
    """A run, by its folder or its file; raises RunFileError."""
    file = recording_at(path)
    return Run(file.resolve().parent.name if file.name == RECORDING else file.stem, file)


class Source:
    """What is in a recording, in the order of its file.

    Args:
        run: which.

    Attributes:
        info: see RunInfo.
        notes: what is missing, a line each; complete once all was read.
        ticks: read so far.

    Raises:
        RunFileError: it cannot be read, or is no recording of this format.
    """

    def __init__(self, run: Run) -> None:
        self.run = run
        self._reader = RunReader(run.path)
        self.info: RunInfo = self._reader.info
        self.notes: list[str] = []
        self.ticks = 0
        self._expected = self.info.first_tick
        self._left_out = self._unreadable = self._fates = 0
        if self.info.first_tick:
            self.notes.append(f"recording began with tick {self.info.first_tick} of the run")

    def items(self, *, fates: bool = False, camera: bool = False) -> Iterator[Item]:
        """Ticks and the gaps between them; what became of messages, and pictures, where they are wanted."""
        decode = msgspec.msgpack.Decoder(TickRecord).decode
        decode_fate, decoder = msgspec.json.Decoder(Fate).decode, TickDecoder()
        topics = {TICK} | (_FATE_TOPICS if fates else set()) | ({CAMERA} if camera else set())
        for item in self._reader.items(topics.__contains__):
            if isinstance(item, Gap):
                yield self._gap(item)
                continue
            try:
                if item.topic == TICK:
                    yield from self._tick(decoder.decode(decode(item.data)))
                elif item.topic == CAMERA:
                    yield image_of(item)
                else:
                    self._fates += 1
                    yield decode_fate(item.data)
            except (msgspec.MsgspecError, ValueError):
                self._unreadable += item.topic != TICK  # a tick's number is missing, which is told of
        self._conclude(fates=fates)

    @property
    def topics(self) -> frozenset[str]:
        """What the file has channels for."""
        return self._reader.topics

    def close(self) -> None:
        """Read no more."""
        self._reader.close()

    def _tick(self, tick: DecodedTick) -> Iterator[Item]:
        number = tick.record.number
        if number > self._expected:
            missing, now_ns = number - self._expected, tick.record.now_ns
            self._left_out += missing
            yield self._gap(Gap(ticks=missing, first_ns=now_ns, last_ns=now_ns, why=DAMAGED))
        self._expected = number + 1
        self.ticks += 1
        if tick.report is None or (tick.record.command is not None and tick.command is None):
            self._unreadable += 1
        yield tick

    def _gap(self, gap: Gap) -> Gap:
        gap = msgspec.structs.replace(gap, after=self._expected - 1)
        self._expected += gap.ticks
        self.notes.append(f"{gap.words}: {gap.why}")
        return gap

    def _conclude(self, *, fates: bool) -> None:
        reader = self._reader
        if reader.cut_off:
            self.notes.append("the file ends early; what was before the cut is there")
        lost = reader.promised.get(TICK, 0) - self.ticks - self._left_out
        if lost > 0:  # the last ones: no number after them tells
            self.notes.append(f"{lost} ticks at its end are missing: {DAMAGED}")
        promised = sum(reader.promised.get(topic, 0) for topic in _FATE_TOPICS)
        if fates and promised > self._fates:
            self.notes.append(f"what became of {promised - self._fates} messages is missing: {DAMAGED}")
        if fates and not self.topics >= _FATE_TOPICS:
            self.notes.append(f"what became of some messages is missing: {DAMAGED}")
        if self._unreadable:
            self.notes.append(f"{self._unreadable} messages in it cannot be read and were left out")


def has_pictures(run: Run) -> bool:
    """Whether there is a picture in it: every recording has a channel for them."""
    reader = RunReader(run.path)
    try:
        return any(isinstance(item, Entry) for item in reader.items(lambda topic: topic == CAMERA))
    finally:
        reader.close()


def joints_of(run: Run) -> int:
    """How many joints the robot has, by the first state that is there; 0: none, or no state."""
    source = Source(run)
    try:
        for item in source.items():
            if isinstance(item, DecodedTick):
                for _, kind, message in item.arrived:
                    if kind == "state":
                        return len(message.joints)  # type: ignore[attr-defined]
        return 0
    finally:
        source.close()
