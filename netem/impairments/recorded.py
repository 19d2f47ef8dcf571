"""`recorded:RUN`: what became of every message in a recorded run, again.

A message gets the fate of the one that was recorded nearest to the same time since the run's first message, of the same
key or else of the same kind: the same losses, copies, flipped bits and delays. Where the same messages come at the same
times, as in virtual time, their fates are the very same; where they come at another rate, the network is. After its
end the recording begins anew.
"""

import statistics
import warnings
from bisect import bisect_left
from collections import defaultdict
from collections.abc import Iterator
from functools import lru_cache
from itertools import pairwise
from pathlib import Path
from typing import ClassVar

import msgspec

from farhand.common.errors import RecordingWarning, RunFileError
from farhand.common.messages.keys import kind_of
from farhand.common.recording.fates import DELIVERED, FATE_TOPICS, ON_THE_WAY, Fate
from farhand.common.recording.place import recording_at
from farhand.common.recording.reader import RunReader
from farhand.common.recording.records import Gap
from farhand.netem.impairments.base import Impairment, ImpairmentContext, Stage, Transit, Word, flip
from farhand.netem.words.reader import SpecReader, path_text


class Recorded(Word, frozen=True):
    """Attributes:
    path: a run's folder or its file.
    """

    path: str
    name: ClassVar[str] = "recorded"
    example: ClassVar[str] = "recorded:runs/20260131-235959-ur5-obstacle"
    description: ClassVar[str] = "what became of every message in a recorded run, again"
    kind: ClassVar[str] = "recorded"
    stage: ClassVar[Stage] = Stage.DUPLICATE
    alone: ClassVar[bool] = True

    @classmethod
    def parse(cls, reader: SpecReader) -> "Recorded":
        """`:RUN`."""
        reader.expect(":", "the run's folder or file")
        return cls(reader.path("the run's folder or file"))

    def text(self) -> str:
        """Canonical word."""
        return f"{self.name}:{path_text(self.path)}"

    def prepare(self) -> None:
        """Read the file; raises RunFileError."""
        recorded_fates(self.path)

    def build(self, context: ImpairmentContext) -> Impairment:
        """The fates of one key's messages, again."""
        return _Again(recorded_fates(self.path), context)


COMPARED = 40
"""Of so many messages the spacing is compared with the recorded one, once."""
ALIKE = 1.25
"""Spacings that differ by no more than this factor are of one rate: real programs are never quite on time."""


class Course:
    """What became of the messages of one key in one direction.

    Args:
        fates: of each message, in order of arrival: its own and those of its copies; empty: it was never seen again.
        arrivals_ns: since the first message of any key (ns).
        length_ns: of the recording.
    """

    def __init__(self, arrivals_ns: list[int], fates: list[list[Fate]], length_ns: int) -> None:
        self._arrivals_ns, self._fates, self._length_ns = arrivals_ns, fates, length_ns
        self.spacing_ns = spacing_of(arrivals_ns)

    def at(self, instant_ns: int) -> list[Fate]:
        """Of the message that was nearest to an instant."""
        within = instant_ns % self._length_ns if instant_ns > self._arrivals_ns[-1] else instant_ns
        after = bisect_left(self._arrivals_ns, within)
        if after == len(self._arrivals_ns):
            return self._fates[-1]
        if after and within - self._arrivals_ns[after - 1] < self._arrivals_ns[after] - within:
            after -= 1
        return self._fates[after]


def spacing_of(arrivals_ns: list[int]) -> float:
    """Median time from one message to the next (ns); 0: of too few to tell."""
    if len(arrivals_ns) < COMPARED:
        return 0.0
    return statistics.median(after - before for before, after in pairwise(arrivals_ns))


class Fates:
    """All of a recording.

    Args:
        courses: by direction and key.
        path: of it, as it was asked for.
    """

    def __init__(self, courses: dict[tuple[str, str], Course], path: str = "") -> None:
        self._courses, self._path = courses, path
        self._said: set[tuple[str, str]] = set()

    def of(self, direction: str, key: str) -> Course | None:
        """Of a key, else of one of the same kind; None: there was none."""
        found = self._courses.get((direction, key))
        if found is not None:
            return found
        kind = kind_of(key)
        alike = (
            course
            for (way, other), course in self._courses.items()
            if way == direction and kind_of(other) == kind
        )
        return next(alike, None)

    def compare(self, direction: str, key: str, spacing_ns: float) -> None:
        """Warn, once for a kind, where messages come at another rate than the recorded ones."""
        course, kind = self.of(direction, key), kind_of(key)
        recorded_ns = course.spacing_ns if course is not None else 0.0
        if not recorded_ns or not spacing_ns or (direction, kind) in self._said:
            return
        if max(spacing_ns, recorded_ns) > ALIKE * min(spacing_ns, recorded_ns):
            self._said.add((direction, kind))
            now_hz, recorded_hz = 1e9 / spacing_ns, 1e9 / recorded_ns
            warnings.warn(
                f"recorded:{self._path}: {kind} messages come {now_hz:.3g} times a second, in it {recorded_hz:.3g} "
                "times: each gets the fate of the one that is nearest in time, and it is not that network message by "
                "message",
                RecordingWarning,
                stacklevel=2,
            )


def recorded_fates(path: str) -> Fates:
    """A recording's network; raises RunFileError."""
    file = recording_at(Path(path), called=f"recorded:{path}")
    return _read(file, path, file.stat().st_mtime_ns)


@lru_cache(maxsize=4)
def _read(file: Path, path: str, _changed_ns: int) -> Fates:
    reader = RunReader(file)
    decode = msgspec.json.Decoder(Fate).decode
    counted = gaps = 0
    rows: dict[tuple[str, str], dict[int, list[Fate]]] = defaultdict(dict)
    topics = set(FATE_TOPICS.values())
    first_ns, last_ns = None, 0
    try:
        for item in reader.items(lambda topic: topic in topics):
            if isinstance(item, Gap):
                gaps += item.ticks
            else:
                fate = decode(item.data)
                counted += 1
                rows[fate.direction, fate.key].setdefault(fate.number, []).append(fate)
                first_ns = fate.arrived_ns if first_ns is None else min(first_ns, fate.arrived_ns)
                last_ns = max(last_ns, fate.arrived_ns)
    except (msgspec.MsgspecError, ValueError) as error:
        raise RunFileError(f"recorded:{path}: the network in it cannot be read: {error}") from None
    if first_ns is None:
        raise RunFileError(
            f"recorded:{path}: holds no network; it is recorded by `farhand record --netem ENDPOINT`, the demo and "
            "`farhand simulate`"
        )
    for lack in _lacks(reader, counted, gaps, set(rows)):
        warnings.warn(f"recorded:{path}: {lack}", RecordingWarning, stacklevel=2)
    return Fates({key: _course(numbered, first_ns, last_ns) for key, numbered in rows.items()}, path)


def _lacks(reader: RunReader, counted: int, gaps: int, courses: set[tuple[str, str]]) -> Iterator[str]:
    """A line about each thing that makes it another network than the one that was."""
    promised = sum(reader.promised.get(topic, 0) for topic in FATE_TOPICS.values())
    if reader.cut_off:
        yield "the file ends early; the network until then is repeated"
    if gaps:
        yield f"{gaps} ticks are missing in it, and what the network did meanwhile"
    if promised > counted or (reader.damaged and not promised):
        lost = f"of {promised - counted}" if promised else "of some"
        yield f"what became {lost} messages is missing; they are taken for the ones next to them"
    for direction in FATE_TOPICS:
        if all(way != direction for way, _ in courses):
            yield f"it holds no message of the {direction}, which is not impaired then"


def _course(numbered: dict[int, list[Fate]], first_ns: int, last_ns: int) -> Course:
    """From the first message on: an emulator may have gone on for long before the run.

    Messages whose number is missing were on the way when the recording ended, and are left out.
    """
    ordered = [sorted(fates, key=lambda fate: fate.copy) for _, fates in sorted(numbered.items())]
    ordered.sort(key=lambda fates: fates[0].arrived_ns)
    arrivals = [fates[0].arrived_ns - first_ns for fates in ordered]
    spacing = (arrivals[-1] - arrivals[0]) // (len(arrivals) - 1) if len(arrivals) > 1 else 0
    return Course(arrivals, ordered, max(1, last_ns - first_ns + spacing))


class _Again(Impairment):
    """At the beginning of the chain it says whether a message is lost and how often it comes; at its end `rest` says of
    each copy when."""

    def __init__(self, fates: Fates, context: ImpairmentContext) -> None:
        self._fates, self._context = fates, context
        self._course: Course | None = None
        self._known = False
        self._first_ns: list[int] = []  # arrivals of the first messages; COMPARED: they were compared
        self.waiting: list[Fate] = []
        self.rest = _Rest(self)

    def apply(self, transit: Transit) -> None:
        if not self._known:
            self._known = True
            self._course = self._fates.of(self._context.direction, transit.packet.key)
        if self._course is None:
            return
        self._compare(transit)
        self.waiting = list(self._course.at(transit.arrived_ns - self._context.origin_ns))
        transit.copies += len(self.waiting) - 1

    def _compare(self, transit: Transit) -> None:
        if len(self._first_ns) < COMPARED:
            self._first_ns.append(transit.arrived_ns)
            if len(self._first_ns) == COMPARED:
                spacing_ns = spacing_of(self._first_ns)
                self._fates.compare(self._context.direction, transit.packet.key, spacing_ns)


class _Rest(Impairment):
    """What became of one copy."""

    def __init__(self, again: _Again) -> None:
        self._again = again

    def apply(self, transit: Transit) -> None:
        if not self._again.waiting:
            return
        fate = self._again.waiting.pop(0)
        transit.delay_ns = fate.drawn_ns
        transit.release_ns = transit.arrived_ns + fate.assigned_ns
        if fate.fate not in (DELIVERED, ON_THE_WAY):
            transit.cause = transit.cause or fate.fate
        elif 0 <= fate.corrupted < 8 * len(transit.packet.payload):
            flip(transit, fate.corrupted)
