"""`uniform:LOW,HIGH[,CORRELATION%]`: delays uniform between two bounds (tc: `delay 125ms 75ms`)."""

from typing import ClassVar

from farhand.common.timing.clock import to_seconds
from farhand.netem.impairments.base import ImpairmentContext
from farhand.netem.impairments.delay import CorrelatedNormal, DelayWord, upper_tail
from farhand.netem.recordings.playback import DelaySampler
from farhand.netem.words.reader import SpecReader, milliseconds_text, percent_text


class Uniform(DelayWord, frozen=True):
    """A uniform delay.

    Attributes:
        low_ns, high_ns: bounds.
        correlation: of neighbouring messages of one key.
    """

    low_ns: int
    high_ns: int
    correlation: float = 0.0
    name: ClassVar[str] = "uniform"
    example: ClassVar[str] = "uniform:50,200"
    description: ClassVar[str] = "delays evenly between 50 and 200 ms"

    @classmethod
    def parse(cls, reader: SpecReader) -> "Uniform":
        """`:LOW,HIGH[,CORRELATION%]`, ms."""
        reader.expect(":", "the smallest and the largest delay in ms")
        low_ns = reader.duration_ns("the smallest delay in ms")
        reader.expect(",", "the largest delay in ms")
        start = reader.position
        high_ns = reader.duration_ns("the largest delay in ms")
        if high_ns < low_ns:
            reader.fail("the largest delay is smaller than the smallest", start)
        start = reader.position
        correlation = reader.optional_correlation()
        if correlation and high_ns == low_ns:
            reader.fail("a correlation without jitter has no meaning", start)
        return cls(low_ns, high_ns, correlation)

    def text(self) -> str:
        """Canonical word."""
        tail = f",{percent_text(self.correlation)}" if self.correlation else ""
        return f"uniform:{milliseconds_text(self.low_ns)},{milliseconds_text(self.high_ns)}{tail}"

    def sampler(self, context: ImpairmentContext) -> DelaySampler:
        """Uniform delays."""
        return _UniformSampler(self, CorrelatedNormal(context.rng("delay"), self.correlation))


class _UniformSampler:
    def __init__(self, word: Uniform, normal: CorrelatedNormal) -> None:
        self._high = to_seconds(word.high_ns)
        self._range = to_seconds(word.high_ns - word.low_ns)
        self._normal = normal

    def draw(self, now_ns: int) -> float:
        return self._high - self._range * upper_tail(self._normal.draw())
