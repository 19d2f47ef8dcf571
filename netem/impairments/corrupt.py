"""`corrupt:P[,CORRELATION%]`: one random bit of the payload is flipped (tc: `corrupt 0.1%`)."""

from typing import ClassVar

import numpy as np

from farhand.netem.impairments.base import Impairment, ImpairmentContext, Stage, Transit, Word, flip
from farhand.netem.impairments.loss_random import RandomEvents
from farhand.netem.words.reader import SpecReader, percent_text


class Corrupt(Word, frozen=True):
    """Corruption.

    Attributes:
        probability: of a flipped bit.
        correlation: of neighbouring messages of one key.
    """

    probability: float
    correlation: float = 0.0
    name: ClassVar[str] = "corrupt"
    example: ClassVar[str] = "corrupt:0.1%"
    description: ClassVar[str] = "one bit of a message in a thousand is flipped"
    kind: ClassVar[str] = "corrupt"
    stage: ClassVar[Stage] = Stage.CORRUPT

    @classmethod
    def parse(cls, reader: SpecReader) -> "Corrupt":
        """`:P[,CORRELATION%]`."""
        reader.expect(":", "the probability of a flipped bit")
        return cls(reader.probability("the probability of a flipped bit"), reader.optional_correlation())

    def text(self) -> str:
        """Canonical word."""
        tail = f",{percent_text(self.correlation)}" if self.correlation else ""
        return f"corrupt:{percent_text(self.probability)}{tail}"

    def build(self, context: ImpairmentContext) -> Impairment:
        """The bit flipper."""
        events = RandomEvents(context, "corrupt", self.probability, self.correlation)
        return _Corrupt(events, context.rng("corrupt-bit"))


class _Corrupt(Impairment):
    def __init__(self, events: RandomEvents, rng: np.random.Generator) -> None:
        self._events = events
        self._random = rng.random

    def apply(self, transit: Transit) -> None:
        if not self._events.draw():
            return
        place = float(self._random())
        if not transit.cause and transit.packet.payload:
            flip(transit, int(place * 8 * len(transit.packet.payload)))
