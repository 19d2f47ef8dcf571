"""Plays a recording's topics: what was said up to an instant, and, after a seek, all that still stood at it."""

import heapq
from collections.abc import Callable, Iterator

from farhand.foxglove.recorded_topics import Played, RecordedTopics
from farhand.foxglove.view import FRAMES, SCENE
from farhand.foxglove.wire import Frames, Scene

Say = Callable[[int, int, bytes], None]
"""Takes the channel's number, the time (ns) and the bytes."""
QUIET_NS, FAR_NS = 3_000_000_000, 60_000_000_000
"""Going back for what stood, the end is where nothing new was found for so long, or so far back."""


class Player:
    """Args:
    topics: of the recording.
    say: takes each message.

    Attributes:
        at_ns: the instant that is shown; nothing is until the first seek.
    """

    def __init__(self, topics: RecordedTopics, say: Say) -> None:
        self.at_ns = topics.start_ns
        self._topics, self._say = topics, say
        self._waiting: list[tuple[int, int, int, bytes]] = []
        self._next = len(topics.chunks)
        self._count = 0
        kinds: list[tuple[int | None, type[Scene] | type[Frames]]] = [
            (topics.number_of(SCENE), Scene),
            (topics.number_of(FRAMES), Frames),
        ]
        self._merged = {number: kind for number, kind in kinds if number is not None}

    def seek(self, at_ns: int) -> None:
        """Go to an instant, and say what stood then: the newest of every topic, every frame, the whole scene."""
        topics = self._topics
        self.at_ns = min(max(at_ns, topics.start_ns), topics.end_ns)
        self._waiting.clear()
        self._next = 0
        while self._next < len(topics.chunks) and topics.chunks[self._next].last_ns <= self.at_ns:
            self._next += 1
        for log_ns, channel, data in self._standing():
            self._say(channel, log_ns, data)

    def advance(self, to_ns: int) -> None:
        """Go on to an instant, and say all on the way."""
        to_ns = min(to_ns, self._topics.end_ns)
        self._load(to_ns)
        while self._waiting and self._waiting[0][0] <= to_ns:
            log_ns, _, channel, data = heapq.heappop(self._waiting)
            self._say(channel, log_ns, data)
        self.at_ns = max(self.at_ns, to_ns)

    @property
    def ended(self) -> bool:
        """Whether there is nothing after the instant."""
        return self.at_ns >= self._topics.end_ns

    def _load(self, to_ns: int) -> None:
        """Chunks that have begun; one may begin before the one before it has ended."""
        chunks = self._topics.chunks
        while self._next < len(chunks) and chunks[self._next].first_ns <= to_ns:
            for log_ns, channel, data in self._topics.messages(self._next):
                if log_ns > self.at_ns:
                    self._count += 1
                    heapq.heappush(self._waiting, (log_ns, self._count, channel, data))
            self._next += 1

    def _standing(self) -> Iterator[Played]:
        newest, merged = self._look_back()
        for channel, messages in merged.items():
            whole = self._merged[channel]()
            for _, _, data in sorted(messages, key=lambda played: played[0]):
                try:
                    whole.take(data)
                except ValueError:
                    continue
            newest[channel] = (max(log_ns for log_ns, _, _ in messages), channel, whole.whole())
        yield from sorted(newest.values(), key=lambda played: played[0])

    def _look_back(self) -> tuple[dict[int, Played], dict[int, list[Played]]]:
        """The newest of every topic, and all messages of those that are put together, far enough back."""
        topics, newest = self._topics, dict[int, Played]()
        merged: dict[int, list[Played]] = {}
        names: set[bytes] = set()
        wanted = set(range(1, len(topics.specs) + 1))
        found_ns = self.at_ns
        for number in range(len(topics.chunks) - 1, -1, -1):
            chunk = topics.chunks[number]
            if chunk.first_ns > self.at_ns:
                continue
            looking = found_ns - chunk.last_ns < QUIET_NS and self.at_ns - chunk.last_ns < FAR_NS
            need = (wanted - set(newest)) | (set(self._merged) if looking else set())
            if not need & topics.numbers_in(number):
                continue
            for played in topics.messages(number):
                log_ns, channel, data = played
                if log_ns > self.at_ns:
                    continue
                if channel in self._merged:
                    if not looking and channel in merged:
                        continue
                    merged.setdefault(channel, []).append(played)
                    new = _names(self._merged[channel], data) - names
                    if new:
                        names |= new
                        found_ns = min(found_ns, log_ns)
                if channel not in newest or newest[channel][0] <= log_ns:
                    newest[channel] = played
        return newest, merged


def _names(kind: type[Scene] | type[Frames], data: bytes) -> frozenset[bytes]:
    one = kind()
    try:
        one.take(data)
    except ValueError:
        return frozenset()
    return one.names
