"""`rate:RATE[,QUEUE[,OVERHEAD]]`: the messages' bytes leave one after the other at RATE (tc: `rate 2mbit limit N`).

What waits or is being sent is bounded by QUEUE bytes (256 kB unless said); a message that does not fit is
dropped (tail drop).
OVERHEAD bytes are added to each message, for the headers that the network carries (tc: `rate 2mbit 66`).
The messages of a direction share one queue, first in, first out, but for a camera's: they have what the others leave of
the rate, and never delay them (low_lane.py).
"""

from typing import ClassVar

from farhand.netem.impairments.base import Impairment, ImpairmentContext, Scope, Stage, Transit, Word
from farhand.netem.impairments.low_lane import LOW_CLASSES, LowLane
from farhand.netem.impairments.rate_by_trace import RateByTrace
from farhand.netem.words.reader import DEFAULT_QUEUE, SpecReader, number_text


class Rate(Word, frozen=True):
    """A rate limit.

    Attributes:
        bits_per_second: the rate.
        queue: bytes that may wait or be under way.
        overhead: bytes that are added to each message.
    """

    bits_per_second: int
    queue: int = DEFAULT_QUEUE
    overhead: int = 0
    name: ClassVar[str] = "rate"
    example: ClassVar[str] = "rate:2mbit or rate:2mbit,64kB"
    description: ClassVar[str] = "bytes leave at this rate, from a queue of bounded size"
    kind: ClassVar[str] = "rate"
    stage: ClassVar[Stage] = Stage.RATE
    scope: ClassVar[Scope] = Scope.LINK

    @classmethod
    def parse(cls, reader: SpecReader) -> Word:
        """`:RATE[,QUEUE[,OVERHEAD]]` or `:trace(FILE[,QUEUE])`."""
        reader.expect(":", "the rate")
        if reader.take("trace("):
            return RateByTrace.arguments(reader)
        rate = reader.rate("the rate")
        queue = reader.size("the queue's size") if reader.take(",") else DEFAULT_QUEUE
        return cls(rate, queue, reader.size("the overhead of a message") if reader.take(",") else 0)

    def text(self) -> str:
        """Canonical word."""
        units = (("gbit", 10**9), ("mbit", 10**6), ("kbit", 10**3), ("bit", 1))
        unit, factor = next(pair for pair in units if self.bits_per_second % pair[1] == 0)
        tail = "" if self.queue == DEFAULT_QUEUE and not self.overhead else f",{self.queue}B"
        tail += f",{self.overhead}B" if self.overhead else ""
        return f"rate:{number_text(self.bits_per_second // factor)}{unit}{tail}"

    def build(self, context: ImpairmentContext) -> Impairment:
        """The queue."""
        return _Rate(self.bits_per_second, self.queue, self.overhead)


class _Rate(Impairment):
    def __init__(self, bits_per_second: int, queue: int, overhead: int) -> None:
        self._overhead = overhead
        self._rate = bits_per_second
        self._queue = queue
        self._free_ns = 0
        self._low = LowLane()

    def apply(self, transit: Transit) -> None:
        if transit.cause:
            return
        size = transit.size + self._overhead
        if transit.flow.message_class in LOW_CLASSES:
            self._low.join(transit, size * 8_000_000_000 // self._rate)
            return
        start_ns = max(self._free_ns, transit.release_ns)
        waiting = (start_ns - transit.release_ns) * self._rate // 8_000_000_000
        if waiting + size > self._queue and waiting > 0:
            transit.cause = "queue"
            return
        self._free_ns = start_ns + size * 8_000_000_000 // self._rate
        self._low.occupied(start_ns, self._free_ns)
        transit.release_ns = self._free_ns
