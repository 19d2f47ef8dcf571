"""`constant:MS`: every message is delayed by the same time (tc: `delay 200ms`)."""

from dataclasses import dataclass
from typing import ClassVar

from farhand.common.timing.clock import to_seconds
from farhand.netem.impairments.base import ImpairmentContext
from farhand.netem.impairments.delay import DelayWord
from farhand.netem.recordings.playback import DelaySampler
from farhand.netem.words.reader import SpecReader, milliseconds_text


class Constant(DelayWord, frozen=True):
    """A constant delay.

    Attributes:
        delay_ns: the delay.
    """

    delay_ns: int
    name: ClassVar[str] = "constant"
    example: ClassVar[str] = "constant:200"
    description: ClassVar[str] = "every message is delayed by 200 ms"

    @classmethod
    def parse(cls, reader: SpecReader) -> "Constant":
        """`:MS`."""
        reader.expect(":", "the delay in ms")
        delay_ns = reader.duration_ns("the delay in ms")
        if reader.text.startswith(",", reader.position):
            reader.fail("a constant delay has no jitter, so neither a second number nor a correlation")
        return cls(delay_ns)

    def text(self) -> str:
        """Canonical word."""
        return f"constant:{milliseconds_text(self.delay_ns)}"

    def sampler(self, context: ImpairmentContext) -> DelaySampler:
        """The constant."""
        return _ConstantSampler(to_seconds(self.delay_ns))


@dataclass(frozen=True, slots=True)
class _ConstantSampler:
    delay: float

    def draw(self, now_ns: int) -> float:
        return self.delay
