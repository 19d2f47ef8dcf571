"""`slot:MIN[,MAX[,COUNT]]`: messages leave only at slot instants, MIN to MAX ms apart (tc: `slot 20ms 30ms`).

At most COUNT messages leave at one instant; the others wait for the next.
"""

from bisect import bisect_left
from typing import ClassVar

import numpy as np

from farhand.netem.impairments.base import Impairment, ImpairmentContext, Scope, Stage, Transit, Word
from farhand.netem.words.reader import SpecReader, milliseconds_text

_KEPT_NS = 10_000_000_000


class Slot(Word, frozen=True):
    """Slotted release.

    Attributes:
        shortest_ns, longest_ns: spacing of the slots, drawn uniformly between.
        count: messages a slot; 0 is any number.
    """

    shortest_ns: int
    longest_ns: int
    count: int = 0
    name: ClassVar[str] = "slot"
    example: ClassVar[str] = "slot:20 or slot:20,30,4"
    description: ClassVar[str] = "messages leave only at instants 20 ms apart"
    kind: ClassVar[str] = "slot"
    stage: ClassVar[Stage] = Stage.SLOT
    scope: ClassVar[Scope] = Scope.LINK

    @classmethod
    def parse(cls, reader: SpecReader) -> "Slot":
        """`:MIN[,MAX[,COUNT]]`, ms."""
        start = reader.position + 1
        reader.expect(":", "the slots' spacing in ms")
        shortest_ns = reader.duration_ns("the slots' spacing in ms")
        if shortest_ns < 10_000:
            reader.fail("the slots' spacing must be at least 0.01 ms", start)
        longest_ns = shortest_ns
        if reader.take(","):
            start = reader.position
            longest_ns = reader.duration_ns("the slots' largest spacing in ms")
            if longest_ns < shortest_ns:
                reader.fail("the largest spacing is smaller than the smallest", start)
        return cls(shortest_ns, longest_ns, reader.count("messages a slot") if reader.take(",") else 0)

    def text(self) -> str:
        """Canonical word."""
        words = [milliseconds_text(self.shortest_ns)]
        if self.longest_ns != self.shortest_ns or self.count:
            words.append(milliseconds_text(self.longest_ns))
        if self.count:
            words.append(str(self.count))
        return f"slot:{','.join(words)}"

    def build(self, context: ImpairmentContext) -> Impairment:
        """The slots."""
        return _Slots(self, context.rng("slot"), context.origin_ns)


class _Slots(Impairment):
    def __init__(self, word: Slot, rng: np.random.Generator, origin_ns: int) -> None:
        self._word = word
        self._rng = rng
        self._starts = [origin_ns]
        self._taken = [0]

    def apply(self, transit: Transit) -> None:
        if transit.cause:
            return
        wanted = transit.release_ns
        index = self._index(wanted, transit.arrived_ns)
        if self._word.count:
            while self._taken[index] >= self._word.count:
                index += 1
                if index == len(self._starts):
                    self._extend()
            self._taken[index] += 1
        transit.release_ns = self._starts[index]

    def _index(self, wanted_ns: int, now_ns: int) -> int:
        """Place of the first slot at or after `wanted_ns`; forgets those long gone."""
        while self._starts[-1] < wanted_ns:
            word = self._word
            behind = wanted_ns - self._starts[-1]
            if word.shortest_ns == word.longest_ns and behind > _KEPT_NS:
                # A fixed grid needs no walking after a long silence.
                self._starts.append(self._starts[-1] + behind // word.shortest_ns * word.shortest_ns)
                self._taken.append(0)
            if self._starts[-1] < wanted_ns:
                self._extend()
        gone = bisect_left(self._starts, now_ns - _KEPT_NS)
        if gone > 1000:
            del self._starts[:gone], self._taken[:gone]
        return bisect_left(self._starts, wanted_ns)

    def _extend(self) -> None:
        word = self._word
        spacing = word.shortest_ns
        if word.longest_ns > word.shortest_ns:
            spacing += int(self._rng.random() * (word.longest_ns - word.shortest_ns))
        self._starts.append(self._starts[-1] + spacing)
        self._taken.append(0)
