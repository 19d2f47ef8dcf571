"""`rate:trace(FILE[,QUEUE])`: a link that carries 1500 bytes at each instant of a packet-delivery trace.

The format is mahimahi's; tc-netem has no such thing. The queue is as for `rate:RATE`.
"""

from collections import deque
from functools import lru_cache
from typing import ClassVar

from farhand.netem.impairments.base import Impairment, ImpairmentContext, Scope, Stage, Transit, Word
from farhand.netem.recordings.rate import DeliverySchedule, RateTrace, load_rate_trace
from farhand.netem.words.reader import DEFAULT_QUEUE, SpecReader, path_text


class RateByTrace(Word, frozen=True):
    """A recorded rate.

    Attributes:
        path: the file.
        queue: bytes that may wait or be under way.
    """

    path: str
    queue: int = DEFAULT_QUEUE
    name: ClassVar[str] = "rate"
    example: ClassVar[str] = "rate:trace(verizon.up,64kB)"
    description: ClassVar[str] = "a recorded rate"
    kind: ClassVar[str] = "rate"
    stage: ClassVar[Stage] = Stage.RATE
    scope: ClassVar[Scope] = Scope.LINK

    @classmethod
    def arguments(cls, reader: SpecReader) -> "RateByTrace":
        """`FILE[,QUEUE])`."""
        reader.example = "rate:trace(verizon.up,64kB)"
        path = reader.path("the packet-delivery trace's file")
        queue = reader.size("the queue's size") if reader.take(",") else DEFAULT_QUEUE
        reader.expect(")", "")
        return cls(path, queue)

    def text(self) -> str:
        """Canonical word."""
        tail = "" if self.queue == DEFAULT_QUEUE else f",{self.queue}B"
        return f"rate:trace({path_text(self.path)}{tail})"

    def prepare(self) -> None:
        """Read the file; raises TraceError."""
        _load(self.path)

    def build(self, context: ImpairmentContext) -> Impairment:
        """The queue."""
        return _Deliveries(_load(self.path).schedule(), self.queue)


class _Deliveries(Impairment):
    def __init__(self, schedule: DeliverySchedule, queue: int) -> None:
        self._schedule = schedule
        self._queue = queue
        self._under_way: deque[tuple[int, int]] = deque()
        self._size = 0

    def apply(self, transit: Transit) -> None:
        if transit.cause:
            return
        while self._under_way and self._under_way[0][0] <= transit.release_ns:
            self._size -= self._under_way.popleft()[1]
        if self._under_way and self._size + transit.size > self._queue:
            transit.cause = "queue"
            return
        transit.release_ns = self._schedule.depart(transit.release_ns, transit.size)
        self._under_way.append((transit.release_ns, transit.size))
        self._size += transit.size


@lru_cache(maxsize=8)
def _load(path: str) -> RateTrace:
    return load_rate_trace(path)
