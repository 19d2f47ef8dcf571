"""`duplicate:P[,CORRELATION%]`: a message comes twice (tc: `duplicate 1%`).

The copy takes the rest of the chain by itself, with a delay of its own.
"""

from typing import ClassVar

from farhand.netem.impairments.base import Impairment, ImpairmentContext, Stage, Transit, Word
from farhand.netem.impairments.loss_random import RandomEvents
from farhand.netem.words.reader import SpecReader, percent_text


class Duplicate(Word, frozen=True):
    """Duplication.

    Attributes:
        probability: of a copy.
        correlation: of neighbouring messages of one key.
    """

    probability: float
    correlation: float = 0.0
    name: ClassVar[str] = "duplicate"
    example: ClassVar[str] = "duplicate:1%"
    description: ClassVar[str] = "a message in a hundred comes twice"
    kind: ClassVar[str] = "duplicate"
    stage: ClassVar[Stage] = Stage.DUPLICATE

    @classmethod
    def parse(cls, reader: SpecReader) -> "Duplicate":
        """`:P[,CORRELATION%]`."""
        reader.expect(":", "the probability of a copy")
        return cls(reader.probability("the probability of a copy"), reader.optional_correlation())

    def text(self) -> str:
        """Canonical word."""
        tail = f",{percent_text(self.correlation)}" if self.correlation else ""
        return f"duplicate:{percent_text(self.probability)}{tail}"

    def build(self, context: ImpairmentContext) -> Impairment:
        """The copier."""
        return _Duplicate(RandomEvents(context, "duplicate", self.probability, self.correlation))


class _Duplicate(Impairment):
    def __init__(self, events: RandomEvents) -> None:
        self._events = events

    def apply(self, transit: Transit) -> None:
        if self._events.draw() and not transit.cause:
            transit.copies += 1
