"""`reorder:drawn|in-order|gap(N[,P[,CORRELATION%]])`: what becomes of the order (tc: `reorder P CORR gap N`).

`drawn`, the default, releases every message at its drawn time, so that the achieved delays are the drawn
ones and later messages may overtake. `in-order` never lets a message of one key overtake another, and so
changes the distribution: gaussian:50,20 at 125 Hz becomes 61.9 +- 14.3 ms. `gap(N,P)` is tc's: all are
delayed except every N-th, which with probability P is sent at once.
"""

from typing import ClassVar, Literal

from farhand.netem.impairments.base import Impairment, ImpairmentContext, InOrder, Stage, Transit, Word
from farhand.netem.impairments.loss_random import RandomEvents
from farhand.netem.words.reader import SpecReader, percent_text

Mode = Literal["drawn", "in-order", "gap"]


class Reorder(Word, frozen=True):
    """The order of release.

    Attributes:
        mode: as drawn, in order, or tc-netem's gap form.
        gap: every how many-th message may be sent at once.
        probability: of that.
        correlation: of neighbouring draws.
    """

    mode: Mode
    gap: int = 1
    probability: float = 1.0
    correlation: float = 0.0
    name: ClassVar[str] = "reorder"
    example: ClassVar[str] = "reorder:in-order or reorder:gap(5,50%)"
    description: ClassVar[str] = "what becomes of the order"
    kind: ClassVar[str] = "reorder"
    stage: ClassVar[Stage] = Stage.REORDER

    @classmethod
    def parse(cls, reader: SpecReader) -> "Reorder":
        """`:drawn`, `:in-order` or `:gap(N[,P[,CORRELATION%]])`."""
        reader.expect(":", "drawn, in-order or gap(...)")
        if reader.take("drawn"):
            return cls("drawn")
        if reader.take("in-order"):
            return cls("in-order")
        reader.expect("gap(", "the number of messages, or drawn, or in-order")
        gap = reader.count("the gap")
        probability = reader.probability("the probability of being sent at once") if reader.take(",") else 1.0
        correlation = reader.optional_correlation()
        reader.expect(")", "")
        return cls("gap", gap, probability, correlation)

    def text(self) -> str:
        """Canonical word."""
        if self.mode != "gap":
            return f"reorder:{self.mode}"
        values = [str(self.gap)]
        if self.probability != 1.0 or self.correlation:
            values.append(percent_text(self.probability))
        if self.correlation:
            values.append(percent_text(self.correlation))
        return f"reorder:gap({','.join(values)})"

    def build(self, context: ImpairmentContext) -> Impairment:
        """What keeps or breaks the order."""
        if self.mode == "in-order":
            return InOrder()
        if self.mode == "gap":
            return _Gap(self.gap, RandomEvents(context, "reorder", self.probability, self.correlation))
        return _AsDrawn()


class _AsDrawn(Impairment):
    def apply(self, transit: Transit) -> None:
        pass


class _Gap(Impairment):
    def __init__(self, gap: int, events: RandomEvents) -> None:
        self._gap = gap
        self._events = events
        self._counter = 0

    def apply(self, transit: Transit) -> None:
        if transit.is_copy:
            return
        at_once = self._events.draw()
        self._counter += 1
        if self._counter < self._gap or not at_once:
            return
        self._counter = 0
        transit.release_ns -= transit.delay_ns
        transit.delay_ns = 0
