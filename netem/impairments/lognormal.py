"""`lognormal:MEAN,SD[,CORRELATION%]`: delays whose logarithm is normal; MEAN and SD are of the delay itself.

mu = ln(mean) - sigma^2 / 2 and sigma^2 = ln(1 + sd^2 / mean^2). tc-netem has no such table built in.
"""

import math
from typing import ClassVar

from farhand.common.timing.clock import to_seconds
from farhand.netem.impairments.base import ImpairmentContext
from farhand.netem.impairments.delay import CorrelatedNormal, MeanSdWord
from farhand.netem.recordings.playback import DelaySampler
from farhand.netem.words.reader import MAX_DELAY_NS, SpecReader


class LogNormal(MeanSdWord, frozen=True):
    """A log-normal delay."""

    name: ClassVar[str] = "lognormal"
    example: ClassVar[str] = "lognormal:50,20"
    description: ClassVar[str] = "log-normal delays: mean 50 ms, standard deviation 20 ms"

    @classmethod
    def parse(cls, reader: SpecReader) -> "LogNormal":
        """`:MEAN,SD[,CORRELATION%]`, ms, the mean above 0."""
        start = reader.position + 1
        found = super().parse(reader)
        if not found.mean_ns:
            reader.fail("the mean delay must be above 0", start)
        return cls(found.mean_ns, found.sd_ns, found.correlation)

    def sampler(self, context: ImpairmentContext) -> DelaySampler:
        """Log-normal delays."""
        return _LogNormalSampler(self, CorrelatedNormal(context.rng("delay"), self.correlation))


class _LogNormalSampler:
    def __init__(self, word: LogNormal, normal: CorrelatedNormal) -> None:
        variance = math.log1p((word.sd_ns / word.mean_ns) ** 2)
        self._mu = math.log(to_seconds(word.mean_ns)) - variance / 2
        self._sigma = math.sqrt(variance)
        self._normal = normal
        self._largest = math.log(to_seconds(MAX_DELAY_NS))

    def draw(self, now_ns: int) -> float:
        return math.exp(min(self._largest, self._mu + self._sigma * self._normal.draw()))
