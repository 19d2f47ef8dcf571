"""Packet-delivery traces of mahimahi: when a link could carry a packet, hence its rate over time.

Each line is an instant in whole ms at which one packet of up to 1500 bytes may leave; a line that occurs
n times lets n packets leave. At the end the trace starts again, as in mahimahi.
"""

from bisect import bisect_left
from dataclasses import dataclass
from pathlib import Path

from farhand.netem.recordings.formats.base import MAX_SAMPLES
from farhand.netem.recordings.text_file import read_text

OPPORTUNITY = 1500
_NANOSECONDS_PER_MS = 1_000_000


@dataclass(frozen=True, eq=False)
class RateTrace:
    """Opportunities to send.

    Attributes:
        times_ns: when 1500 bytes may leave, never decreasing, the last > 0 (ns since the start).
    """

    times_ns: tuple[int, ...]

    def schedule(self) -> "DeliverySchedule":
        """A fresh queue over these opportunities."""
        return DeliverySchedule(self)


class DeliverySchedule:
    """First in, first out: each message takes the next free opportunities, as many bytes as it has."""

    def __init__(self, trace: RateTrace) -> None:
        self._times = trace.times_ns
        self._round_ns = trace.times_ns[-1]
        self._origin_ns: int | None = None
        self._taken = 0
        self._left = 0

    def depart(self, now_ns: int, size: int) -> int:
        """Instant (ns) at which the last byte of a message that arrives at `now_ns` has left."""
        if self._origin_ns is None:
            self._origin_ns = now_ns
        since = max(0, now_ns - self._origin_ns)
        first = since // self._round_ns * len(self._times) + bisect_left(self._times, since % self._round_ns)
        if first > self._taken:
            self._taken, self._left = first, 0
        # What is left of an opportunity serves only those who already waited for it.
        if self._left and self._instant(self._taken - 1) < since:
            self._left = 0
        remaining = max(size, 1) - self._left
        if remaining <= 0:
            self._left = -remaining
        else:
            opportunities = -(-remaining // OPPORTUNITY)
            self._taken += opportunities
            self._left = opportunities * OPPORTUNITY - remaining
        return self._origin_ns + max(since, self._instant(self._taken - 1))

    def _instant(self, index: int) -> int:
        rounds, place = divmod(index, len(self._times))
        return rounds * self._round_ns + self._times[place]


def load_rate_trace(path: str | Path) -> RateTrace:
    """Read a packet-delivery trace; raises TraceError that names the line."""
    text = read_text(path)
    times: list[int] = []
    for line, content in enumerate(text.lines, start=1):
        word = content.strip()
        if not word or word.startswith("#"):
            continue
        if not (word.isascii() and word.isdigit() and len(word) <= 12):
            text.fail(f"expected a whole number of ms, got {text.excerpt(line)}", line)
        instant_ns = int(word) * _NANOSECONDS_PER_MS
        if times and instant_ns < times[-1]:
            text.fail(f"the time goes backwards: {text.excerpt(line)}", line)
        if len(times) >= MAX_SAMPLES:
            text.fail(f"more than {MAX_SAMPLES} lines", line)
        times.append(instant_ns)
    if not times:
        text.fail("no opportunities to send")
    if times[-1] == 0:
        text.fail("the last opportunity must come after 0 ms, or the rate is infinite")
    return RateTrace(tuple(times))
