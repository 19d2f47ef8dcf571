"""`paretonormal:MEAN,SD[,CORRELATION%]`: a quarter normal, three quarters Pareto, as tc's table mixes them.

The sum 0.25 N + 0.75 P of a standard normal and a standardised Pareto variable, scaled to the deviation
asked for (tc: `delay 50ms 20ms distribution paretonormal`).
"""

import math
from typing import ClassVar

from farhand.common.timing.clock import to_seconds
from farhand.netem.impairments.base import ImpairmentContext
from farhand.netem.impairments.delay import CorrelatedNormal, MeanSdWord, Normals, upper_tail
from farhand.netem.impairments.pareto import standard_pareto
from farhand.netem.recordings.playback import DelaySampler

_SCALE = 1 / math.hypot(0.25, 0.75)
NORMAL_PART, PARETO_PART = 0.25 * _SCALE, 0.75 * _SCALE


class ParetoNormal(MeanSdWord, frozen=True):
    """A delay between normal and Pareto."""

    name: ClassVar[str] = "paretonormal"
    example: ClassVar[str] = "paretonormal:50,20"
    description: ClassVar[str] = (
        "a quarter normal, three quarters Pareto: mean 50 ms, standard deviation 20 ms"
    )

    def sampler(self, context: ImpairmentContext) -> DelaySampler:
        """Delays of the sum."""
        normals = Normals(context.rng("delay"))
        return _ParetoNormalSampler(
            self, CorrelatedNormal(normals, self.correlation), CorrelatedNormal(normals, self.correlation)
        )


class _ParetoNormalSampler:
    def __init__(self, word: ParetoNormal, normal: CorrelatedNormal, pareto: CorrelatedNormal) -> None:
        self._mean, self._sd = to_seconds(word.mean_ns), to_seconds(word.sd_ns)
        self._normal, self._pareto = normal, pareto

    def draw(self, now_ns: int) -> float:
        pareto = standard_pareto(upper_tail(self._pareto.draw()))
        return self._mean + self._sd * (NORMAL_PART * self._normal.draw() + PARETO_PART * pareto)
