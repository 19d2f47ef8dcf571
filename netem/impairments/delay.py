"""Delay: what all delay words share. Draws below zero are a delay of zero, as in tc-netem, and counted.

Jitter correlation is a Gaussian copula: z_n = rho z_(n-1) + sqrt(1 - rho^2) e_n is standard normal for
every n, and the delay is the distribution's quantile at Phi(z_n). So correlated delays keep exactly the
distribution that was asked for (tc-netem blends uniform numbers, which changes it).
"""

import math
from typing import ClassVar

import numpy as np

from farhand.common.timing.clock import to_ns
from farhand.netem.impairments.base import Impairment, ImpairmentContext, Stage, Transit, Word
from farhand.netem.recordings.playback import DelaySampler
from farhand.netem.words.reader import SpecReader, milliseconds_text, percent_text

_SQRT_HALF = math.sqrt(0.5)
_BLOCK = 64


class DelayWord(Word, frozen=True):
    """A delay word; `build` makes the stage around the sampler."""

    kind: ClassVar[str] = "delay"
    stage: ClassVar[Stage] = Stage.DELAY

    @property
    def cause(self) -> str:
        """Of what it loses, for the counters: the word, as it was asked for."""
        return self.name

    def sampler(self, context: ImpairmentContext) -> DelaySampler:
        """The source of delays."""
        raise NotImplementedError

    def build(self, context: ImpairmentContext) -> Impairment:
        """The impairment that delays each message by a draw of `sampler`."""
        return Delay(self.sampler(context), self.cause)


class Delay(Impairment):
    """Adds a drawn delay to every message.

    Args:
        sampler: where the delays come from.
        cause: of the loss of those for which there is none.
    """

    def __init__(self, sampler: DelaySampler, cause: str) -> None:
        self._sampler, self._cause = sampler, cause
        self.below_zero = 0

    def apply(self, transit: Transit) -> None:
        """Draw, and release that much later."""
        delay = self._sampler.draw(transit.arrived_ns)
        if delay is None:
            transit.cause = transit.cause or self._cause
            return
        if delay < 0:
            self.below_zero += 1
            delay = 0.0
        transit.delay_ns = to_ns(delay)
        transit.release_ns += transit.delay_ns


class Normals:
    """Standard normal numbers, the same as one by one from `rng`, which nobody else may draw from; drawn in blocks,
    as a single one takes longer than all the rest of a delay."""

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng = rng
        self._drawn: list[float] = []

    def draw(self) -> float:
        """The next number."""
        if not self._drawn:
            self._drawn = np.flip(self._rng.standard_normal(size=_BLOCK)).tolist()
        return self._drawn.pop()


class CorrelatedNormal:
    """Standard normal numbers, each correlated with the one before.

    Args:
        source: of the innovations; a generator serves this one alone.
        correlation: of neighbours, 0 <= rho < 1.
    """

    def __init__(self, source: "np.random.Generator | Normals", correlation: float) -> None:
        self._normal = (source if isinstance(source, Normals) else Normals(source)).draw
        self._rho = correlation
        self._scale = math.sqrt(1 - correlation * correlation)
        self._z: float | None = None

    def draw(self) -> float:
        """The next number."""
        innovation = self._normal()
        if self._rho == 0.0 or self._z is None:
            self._z = innovation
        else:
            self._z = self._rho * self._z + self._scale * innovation
        return self._z


def upper_tail(z: float) -> float:
    """1 - Phi(z), uniform on (0, 1) for a standard normal z."""
    return 0.5 * math.erfc(z * _SQRT_HALF)


class MeanSdWord(DelayWord, frozen=True):
    """A delay with a mean, a standard deviation and perhaps a correlation.

    Attributes:
        mean_ns, sd_ns: of the distribution, before draws below zero become zero.
        correlation: of neighbouring messages of one key.
    """

    mean_ns: int
    sd_ns: int
    correlation: float = 0.0

    @classmethod
    def parse(cls, reader: SpecReader) -> "MeanSdWord":
        """`:MEAN,SD[,CORRELATION%]`, ms."""
        reader.expect(":", "the mean and the standard deviation in ms")
        mean_ns = reader.duration_ns("the mean delay in ms")
        reader.expect(",", "the standard deviation in ms")
        sd_ns = reader.duration_ns("the standard deviation in ms")
        start = reader.position
        correlation = reader.optional_correlation()
        if correlation and not sd_ns:
            reader.fail("a correlation without jitter has no meaning", start)
        return cls(mean_ns, sd_ns, correlation)

    def text(self) -> str:
        """Canonical word."""
        tail = f",{percent_text(self.correlation)}" if self.correlation else ""
        return f"{self.name}:{milliseconds_text(self.mean_ns)},{milliseconds_text(self.sd_ns)}{tail}"
