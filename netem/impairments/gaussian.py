"""`gaussian:MEAN,SD[,CORRELATION%]`: normal delays (tc: `delay 50ms 20ms distribution normal`).

A draw below zero is a delay of zero, as in tc-netem; at 50,20 that is 0.6% of the messages and lifts the
mean by 0.04 ms.
"""

from typing import ClassVar

from farhand.common.timing.clock import to_seconds
from farhand.netem.impairments.base import ImpairmentContext
from farhand.netem.impairments.delay import CorrelatedNormal, MeanSdWord
from farhand.netem.recordings.playback import DelaySampler


class Gaussian(MeanSdWord, frozen=True):
    """A normal delay."""

    name: ClassVar[str] = "gaussian"
    example: ClassVar[str] = "gaussian:50,20"
    description: ClassVar[str] = "normal delays: mean 50 ms, standard deviation 20 ms"

    def sampler(self, context: ImpairmentContext) -> DelaySampler:
        """Normal delays."""
        return _GaussianSampler(self, CorrelatedNormal(context.rng("delay"), self.correlation))


class _GaussianSampler:
    def __init__(self, word: Gaussian, normal: CorrelatedNormal) -> None:
        self._mean, self._sd = to_seconds(word.mean_ns), to_seconds(word.sd_ns)
        self._normal = normal

    def draw(self, now_ns: int) -> float:
        return self._mean + self._sd * self._normal.draw()
