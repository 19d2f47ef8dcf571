"""Replay of a recorded trace, message by message.

Timed and slotted traces: the sample in force at an instant since the first message, that is the latest
one sent at or before it. Untimed traces: one sample for each message.
"""

import math
from bisect import bisect_right
from typing import Literal, Protocol, get_args

from farhand.common.timing.clock import NANOSECONDS_PER_SECOND

AtEnd = Literal["wrap", "stop", "hold"]
AT_ENDS: tuple[AtEnd, ...] = get_args(AtEnd)


class DelaySampler(Protocol):
    """Anything that gives each message of one direction its delay."""

    def draw(self, now_ns: int) -> float | None:
        """Delay (s) of the message that enters at `now_ns` (never decreasing); None: it is lost."""
        ...


class TimedReplay:
    """Replays samples that have times.

    Args:
        starts: from when on each sample is in force (ns since the first message; starts[0] = 0).
        delays: s, NaN = lost.
        end_ns: where the last sample's time is over.
        at_end: "wrap" starts again; "stop" loses every message; "hold" keeps the last sample.
        hold_gaps: a lost sample holds its messages until the next that arrived, instead of losing them.
    """

    def __init__(
        self, starts: list[int], delays: list[float], end_ns: int, at_end: AtEnd, hold_gaps: bool
    ) -> None:
        self._starts = starts
        self._delays = delays
        self._end_ns = end_ns
        self._at_end = at_end
        self._next = _next_arrivals(starts, delays, end_ns) if hold_gaps else None
        self._origin_ns: int | None = None

    def draw(self, now_ns: int) -> float | None:
        """Delay (s) of the message that enters at `now_ns`; None: it is lost."""
        if self._origin_ns is None:
            self._origin_ns = now_ns
        since = max(0, now_ns - self._origin_ns)
        if since >= self._end_ns:
            if self._at_end == "stop":
                return None
            since = since % self._end_ns if self._at_end == "wrap" else self._end_ns - 1
        index = bisect_right(self._starts, since) - 1
        delay = self._delays[index]
        if not math.isnan(delay):
            return delay
        if self._next is None:
            return None
        arrival = self._next[index]
        if arrival is None:
            return None
        instant_ns, delay = arrival
        return (instant_ns - since) / NANOSECONDS_PER_SECOND + delay


class UntimedReplay:
    """Replays one sample for each message; see TimedReplay for `at_end`."""

    def __init__(self, delays: list[float], at_end: AtEnd) -> None:
        self._delays = delays
        self._at_end = at_end
        self._drawn = 0

    def draw(self, now_ns: int) -> float | None:
        """Delay (s) of the next message; None: it is lost."""
        index, count = self._drawn, len(self._delays)
        self._drawn += 1
        if index >= count:
            if self._at_end == "stop":
                return None
            index = index % count if self._at_end == "wrap" else count - 1
        delay = self._delays[index]
        return None if math.isnan(delay) else delay


def _next_arrivals(starts: list[int], delays: list[float], end_ns: int) -> list[tuple[int, float] | None]:
    """For each sample, the next one that was not lost, beyond the end those of the next round."""
    upcoming: tuple[int, float] | None = None
    for start, delay in zip(starts, delays, strict=True):
        if not math.isnan(delay):
            upcoming = (start + end_ns, delay)
            break
    found: list[tuple[int, float] | None] = [None] * len(starts)
    for index in range(len(starts) - 1, -1, -1):
        if not math.isnan(delays[index]):
            upcoming = (starts[index], delays[index])
        found[index] = upcoming
    return found
