"""`pareto:MEAN,SD[,CORRELATION%]`: heavy-tailed delays (tc: `delay 50ms 20ms distribution pareto`).

A Pareto variable of shape 3, as in tc-netem, but shifted and scaled so that mean and standard deviation
are the ones asked for, and without the cut at four deviations of tc's table. The smallest delay is
MEAN - SD / sqrt(3).
"""

import math
from typing import ClassVar

from farhand.common.timing.clock import to_seconds
from farhand.netem.impairments.base import ImpairmentContext
from farhand.netem.impairments.delay import CorrelatedNormal, MeanSdWord, upper_tail
from farhand.netem.recordings.playback import DelaySampler

SHAPE = 3.0
_MEAN = SHAPE / (SHAPE - 1)
_SD = math.sqrt(SHAPE / (SHAPE - 2)) / (SHAPE - 1)


def standard_pareto(tail: float) -> float:
    """Pareto quantile with mean 0 and deviation 1 at the upper tail probability `tail` in (0, 1]."""
    return float((max(tail, 1e-300) ** (-1 / SHAPE) - _MEAN) / _SD)


class Pareto(MeanSdWord, frozen=True):
    """A Pareto delay."""

    name: ClassVar[str] = "pareto"
    example: ClassVar[str] = "pareto:50,20"
    description: ClassVar[str] = "heavy-tailed delays: mean 50 ms, standard deviation 20 ms"

    def sampler(self, context: ImpairmentContext) -> DelaySampler:
        """Pareto delays."""
        return _ParetoSampler(self, CorrelatedNormal(context.rng("delay"), self.correlation))


class _ParetoSampler:
    def __init__(self, word: Pareto, normal: CorrelatedNormal) -> None:
        self._mean, self._sd = to_seconds(word.mean_ns), to_seconds(word.sd_ns)
        self._normal = normal

    def draw(self, now_ns: int) -> float:
        return self._mean + self._sd * standard_pareto(upper_tail(self._normal.draw()))
