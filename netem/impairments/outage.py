"""`outage:every(PERIOD,LENGTH)`, `at(START,LENGTH,...)`, `random(UP,DOWN)`: times without a network.

What arrives meanwhile is dropped, or with `hold` as the last parameter kept and released in one burst at
the end, as TCP does. Times count from the first message; the first periodic outage comes after one PERIOD.
tc-netem has none (one sets `loss 100%` by script).
"""

from bisect import bisect_right
from typing import ClassVar, Literal

import numpy as np

from farhand.netem.impairments.base import (
    Impairment,
    ImpairmentContext,
    LossModel,
    Scope,
    Stage,
    Transit,
    Word,
)
from farhand.netem.words.reader import MAX_DURATION_NS, SpecReader, seconds_text

Form = Literal["every", "at", "random"]
FORMS: tuple[Form, ...] = ("every", "at", "random")
_KEPT = 4096


class Outage(Word, frozen=True):
    """Outages.

    Attributes:
        form: periodic, at given times, or random.
        times_ns: (period, length), (start, length, start, length, ...), or (mean up, mean down).
        hold: whether messages wait for the end instead of being dropped.
    """

    form: Form
    times_ns: tuple[int, ...]
    hold: bool = False
    name: ClassVar[str] = "outage"
    example: ClassVar[str] = "outage:every(30s,2s) or outage:at(5s,2s,hold)"
    description: ClassVar[str] = "times without a network"
    kind: ClassVar[str] = "outage"
    stage: ClassVar[Stage] = Stage.OUTAGE
    scope: ClassVar[Scope] = Scope.LINK

    @classmethod
    def parse(cls, reader: SpecReader) -> "Outage":
        """`:FORM(TIME,TIME...[,hold|drop])`."""
        reader.expect(":", "every(...), at(...) or random(...)")
        for form in FORMS:
            if reader.take(f"{form}("):
                break
        else:
            reader.fail("expected every(...), at(...) or random(...)")
        start = reader.position
        times_ns: list[int] = []
        hold = False
        while True:
            if reader.take("hold"):
                hold = True
                break
            if reader.take("drop"):
                break
            times_ns.append(reader.duration_ns("a time", MAX_DURATION_NS))
            if not reader.take(","):
                break
        reader.expect(")", "")
        _check(form, times_ns, reader, start)
        return cls(form, tuple(times_ns), hold)

    def text(self) -> str:
        """Canonical word."""
        tail = ",hold" if self.hold else ""
        return f"outage:{self.form}({','.join(map(seconds_text, self.times_ns))}{tail})"

    def build(self, context: ImpairmentContext) -> Impairment:
        """The outages."""
        if self.form == "every":
            return OutageStage(_Every(self.times_ns[0], self.times_ns[1], context.origin_ns), self.hold)
        if self.form == "at":
            starts = [context.origin_ns + start for start in self.times_ns[::2]]
            return OutageStage(Windows(starts, list(self.times_ns[1::2])), self.hold)
        schedule = _Random(self.times_ns[0], self.times_ns[1], context.rng("outage"), context.origin_ns)
        return OutageStage(schedule, self.hold)


def _check(form: Form, times_ns: list[int], reader: SpecReader, start: int) -> None:
    if form != "at" and len(times_ns) != 2:
        what = "the period and the length" if form == "every" else "the mean time up and the mean time down"
        reader.fail(f"{form}(...) takes two times, {what}", start)
    if not times_ns or len(times_ns) % 2:
        reader.fail("at(...) takes pairs of a start and a length", start)
    if form == "every" and not 0 < times_ns[1] < times_ns[0]:
        reader.fail("the length must be above 0 and below the period", start)
    if form == "random" and min(times_ns) < 1_000_000:
        reader.fail("the mean times must be at least 1 ms", start)
    if form == "at":
        ends = [0, *(a + b for a, b in zip(times_ns[::2], times_ns[1::2], strict=True))]
        if any(a < end for a, end in zip(times_ns[::2], ends, strict=False)) or 0 in times_ns[1::2]:
            reader.fail("the outages must be in order, apart, and longer than 0", start)


class Windows:
    """Given outages, in order of their starts.

    Args:
        starts_ns: absolute starts.
        lengths_ns: of each.
    """

    def __init__(self, starts_ns: list[int], lengths_ns: list[int]) -> None:
        self.starts_ns = starts_ns
        self.lengths_ns = lengths_ns

    def end_ns(self, instant_ns: int) -> int | None:
        """End of the outage in which the instant lies; None if it lies in none."""
        index = bisect_right(self.starts_ns, instant_ns) - 1
        if index < 0:
            return None
        end_ns = self.starts_ns[index] + self.lengths_ns[index]
        return end_ns if instant_ns < end_ns else None


class _Every:
    def __init__(self, period_ns: int, length_ns: int, origin_ns: int) -> None:
        self._period_ns, self._length_ns, self._origin_ns = period_ns, length_ns, origin_ns

    def end_ns(self, instant_ns: int) -> int | None:
        turn, into = divmod(instant_ns - self._origin_ns, self._period_ns)
        return instant_ns - into + self._length_ns if turn >= 1 and into < self._length_ns else None


class _Random(Windows):
    def __init__(self, up_ns: int, down_ns: int, rng: np.random.Generator, origin_ns: int) -> None:
        super().__init__([], [])
        self._up_ns, self._down_ns, self._rng = up_ns, down_ns, rng
        self._known_ns = origin_ns

    def end_ns(self, instant_ns: int) -> int | None:
        while self._known_ns <= instant_ns:
            start_ns = self._known_ns + int(self._rng.exponential(self._up_ns))
            length_ns = 1 + int(self._rng.exponential(self._down_ns))
            self.starts_ns.append(start_ns)
            self.lengths_ns.append(length_ns)
            self._known_ns = start_ns + length_ns
            if len(self.starts_ns) > 2 * _KEPT:
                del self.starts_ns[:_KEPT], self.lengths_ns[:_KEPT]
        return super().end_ns(instant_ns)


class OutageStage(LossModel):
    """Drops or holds what arrives in an outage.

    Args:
        schedule: when there is none of a network.
        hold: keep messages until the end.
    """

    def __init__(self, schedule: Windows | _Every, hold: bool) -> None:
        self._schedule = schedule
        self._hold = hold

    def loses(self, transit: Transit, instant_ns: int) -> bool:
        """Whether a transmission at this instant is lost."""
        return self._schedule.end_ns(instant_ns) is not None

    def apply(self, transit: Transit) -> None:
        """Drop, or release at the end at the earliest."""
        end_ns = self._schedule.end_ns(transit.release_ns)
        if end_ns is None:
            return
        if self._hold:
            transit.release_ns = end_ns
        else:
            transit.cause = transit.cause or "outage"
