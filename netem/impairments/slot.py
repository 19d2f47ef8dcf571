"""`slot:MIN[,MAX[,COUNT]][,BYTES]`: messages leave only at slot instants, MIN to MAX ms apart (tc: `slot 20ms 30ms`);
`slot:normal(MEAN,SD[,COUNT][,BYTES])`: the spacing is drawn (tc: `slot distribution normal 20ms 5ms`).

At most COUNT messages leave at one instant, and none after the one with which BYTES are reached, as in tc-netem; the
others wait for the next. A spacing below 0.01 ms is 0.01 ms.
"""

from bisect import bisect_left
from collections.abc import Callable
from typing import ClassVar

from farhand.netem.impairments.base import Impairment, ImpairmentContext, Scope, Stage, Transit, Word
from farhand.netem.impairments.delay import upper_tail
from farhand.netem.impairments.pareto import standard_pareto
from farhand.netem.impairments.paretonormal import NORMAL_PART, PARETO_PART
from farhand.netem.words.reader import SpecReader, milliseconds_text

_KEPT_NS = 10_000_000_000
_LEAST_NS = 10_000
DISTRIBUTIONS = ("normal", "pareto", "paretonormal")


class Slot(Word, frozen=True):
    """Slotted release, the spacing uniform between two bounds.

    Attributes:
        shortest_ns, longest_ns: spacing of the slots, drawn uniformly between.
        count: messages a slot; 0 is any number.
        size: bytes with which a slot is full; 0 is any number.
    """

    shortest_ns: int
    longest_ns: int
    count: int = 0
    size: int = 0
    name: ClassVar[str] = "slot"
    example: ClassVar[str] = "slot:20 or slot:20,30,4"
    description: ClassVar[str] = "messages leave only at instants 20 ms apart"
    kind: ClassVar[str] = "slot"
    stage: ClassVar[Stage] = Stage.SLOT
    scope: ClassVar[Scope] = Scope.LINK

    @classmethod
    def parse(cls, reader: SpecReader) -> "Slot | DrawnSlot":
        """`:MIN[,MAX[,COUNT]][,BYTES]` or `:DISTRIBUTION(MEAN,SD[,COUNT][,BYTES])`, ms."""
        start = reader.position + 1
        reader.expect(":", "the slots' spacing in ms, or its distribution")
        if reader.rest()[:1].isalpha():
            return DrawnSlot.parse(reader)
        shortest_ns = _spacing(reader, "the slots' spacing in ms", start)
        longest_ns, count, size = shortest_ns, 0, 0
        if reader.take(","):
            size = reader.optional_size()
            if not size:
                start = reader.position
                longest_ns = reader.duration_ns("the slots' largest spacing in ms")
                if longest_ns < shortest_ns:
                    reader.fail("the largest spacing is smaller than the smallest", start)
                count, size = _bounds(reader)
        return cls(shortest_ns, longest_ns, count, size)

    def text(self) -> str:
        """Canonical word."""
        words = [milliseconds_text(self.shortest_ns)]
        if self.longest_ns != self.shortest_ns or self.count:
            words.append(milliseconds_text(self.longest_ns))
        return f"slot:{','.join(words + _bounds_text(self.count, self.size))}"

    def build(self, context: ImpairmentContext) -> Impairment:
        """The slots."""
        rng = context.rng("slot")
        shortest_ns, width_ns = self.shortest_ns, self.longest_ns - self.shortest_ns
        if not width_ns:
            return _Slots(lambda: shortest_ns, context.origin_ns, self.count, self.size, shortest_ns)
        return _Slots(
            lambda: shortest_ns + int(rng.random() * width_ns), context.origin_ns, self.count, self.size
        )


class DrawnSlot(Word, frozen=True):
    """Slotted release, the spacing of a distribution.

    Attributes:
        distribution: one of DISTRIBUTIONS.
        mean_ns, sd_ns: of the spacing, before draws below the smallest one become that.
        count, size: as of Slot.
    """

    distribution: str
    mean_ns: int
    sd_ns: int
    count: int = 0
    size: int = 0
    name: ClassVar[str] = Slot.name
    example: ClassVar[str] = "slot:normal(20,5)"
    description: ClassVar[str] = Slot.description
    kind: ClassVar[str] = Slot.kind
    stage: ClassVar[Stage] = Slot.stage
    scope: ClassVar[Scope] = Slot.scope

    @classmethod
    def parse(cls, reader: SpecReader) -> "DrawnSlot":
        """`DISTRIBUTION(MEAN,SD[,COUNT][,BYTES])`, ms."""
        start = reader.position
        distribution = reader.name()
        distribution = "normal" if distribution == "gaussian" else distribution
        if distribution not in DISTRIBUTIONS:
            reader.fail(f"the slots' spacing in ms, or its distribution: {', '.join(DISTRIBUTIONS)}", start)
        reader.expect("(", "the mean spacing in ms")
        mean_ns = _spacing(reader, "the slots' mean spacing in ms", reader.position)
        reader.expect(",", "the standard deviation in ms")
        sd_ns = reader.duration_ns("the standard deviation in ms")
        count, size = _bounds(reader)
        reader.expect(")", "")
        return cls(distribution, mean_ns, sd_ns, count, size)

    def text(self) -> str:
        """Canonical word."""
        words = [milliseconds_text(self.mean_ns), milliseconds_text(self.sd_ns)]
        return f"slot:{self.distribution}({','.join(words + _bounds_text(self.count, self.size))})"

    def build(self, context: ImpairmentContext) -> Impairment:
        """The slots."""
        normal = context.rng("slot").standard_normal
        draws: dict[str, Callable[[], float]] = {
            "normal": normal,
            "pareto": lambda: standard_pareto(upper_tail(normal())),
            "paretonormal": lambda: (
                NORMAL_PART * normal() + PARETO_PART * standard_pareto(upper_tail(normal()))
            ),
        }
        draw = draws[self.distribution]
        mean_ns, sd_ns = self.mean_ns, self.sd_ns
        return _Slots(
            lambda: max(_LEAST_NS, round(mean_ns + sd_ns * draw())), context.origin_ns, self.count, self.size
        )


def _spacing(reader: SpecReader, what: str, start: int) -> int:
    found_ns = reader.duration_ns(what)
    if found_ns < _LEAST_NS:
        reader.fail("the slots' spacing must be at least 0.01 ms", start)
    return found_ns


def _bounds(reader: SpecReader) -> tuple[int, int]:
    """`[,COUNT][,BYTES]`."""
    count = size = 0
    if reader.take(","):
        size = reader.optional_size()
        if not size:
            count = reader.count("messages a slot")
            size = reader.size("the bytes of a slot") if reader.take(",") else 0
    return count, size


def _bounds_text(count: int, size: int) -> list[str]:
    return [*([str(count)] if count else []), *([f"{size}B"] if size else [])]


class _Slots(Impairment):
    """The slots of a direction.

    Args:
        spacing: draws the next spacing (ns).
        origin_ns: the first slot.
        count, size: messages and bytes of a slot; 0: any number.
        grid_ns: the spacing, where it is always the same; else 0.
    """

    def __init__(
        self, spacing: Callable[[], int], origin_ns: int, count: int, size: int, grid_ns: int = 0
    ) -> None:
        self._spacing = spacing
        self._count, self._size, self._grid_ns = count, size, grid_ns
        self._starts = [origin_ns]
        self._taken = [0]
        self._bytes = [0]

    def apply(self, transit: Transit) -> None:
        if transit.cause:
            return
        index = self._index(transit.release_ns, transit.arrived_ns)
        while self._is_full(index):
            index += 1
            if index == len(self._starts):
                self._extend()
        self._taken[index] += 1
        self._bytes[index] += transit.size
        transit.release_ns = self._starts[index]

    def _is_full(self, index: int) -> bool:
        return 0 < self._count <= self._taken[index] or 0 < self._size <= self._bytes[index]

    def _index(self, wanted_ns: int, now_ns: int) -> int:
        """Place of the first slot at or after `wanted_ns`; forgets those long gone."""
        while self._starts[-1] < wanted_ns:
            behind = wanted_ns - self._starts[-1]
            if self._grid_ns and behind > _KEPT_NS:
                # A fixed grid needs no walking after a long silence.
                self._append(self._starts[-1] + behind // self._grid_ns * self._grid_ns)
            if self._starts[-1] < wanted_ns:
                self._extend()
        gone = bisect_left(self._starts, now_ns - _KEPT_NS)
        if gone > 1000:
            del self._starts[:gone], self._taken[:gone], self._bytes[:gone]
        return bisect_left(self._starts, wanted_ns)

    def _extend(self) -> None:
        self._append(self._starts[-1] + self._spacing())

    def _append(self, start_ns: int) -> None:
        self._starts.append(start_ns)
        self._taken.append(0)
        self._bytes.append(0)
