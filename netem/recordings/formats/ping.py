"""Output of `ping`: iputils (also with -D and -O), BSD and macOS, Windows.

Missing sequence numbers and time-outs are lost messages. Sending times come from the time stamps of -D,
else evenly from the summary's total time, else there are none.
"""

import math
import re
from typing import ClassVar

from farhand.netem.recordings.formats.base import (
    TraceFormat,
    TraceOptions,
    TraceSamples,
    TraceText,
    check_delay,
    number,
)

_REPLY = re.compile(
    r"(?:\[([0-9.]{1,24})\] )?.*?(?:icmp_seq[= ](\d{1,9})\b.*?)?\btime[=<]\s*([0-9.,]{1,24})\s*ms"
)
_LOST = re.compile(r"(?:no answer yet for|Request timeout for) icmp_seq[= ](\d{1,9})")
_UNREACHABLE = re.compile(r"icmp_seq[= ](\d{1,9}) .*(?:nreachable|exceeded)")
_SUMMARY = re.compile(r"(\d{1,9}) packets transmitted.*\btime (\d{1,12})\s*ms")
_WINDOWS_LOST = re.compile(r"Request timed out\.?\s*\Z")
_ALMOST = re.compile(r"\d+ bytes from|Reply from")
_SEQUENCE = 1 << 16


class Ping(TraceFormat):
    """Output of ping."""

    name: ClassVar[str] = "ping"

    def matches(self, text: TraceText) -> bool:
        """Whether the beginning looks like a ping."""
        return any(
            line.startswith(("PING ", "PING6", "Pinging ")) or ("time=" in line and "ms" in line)
            for line in text.lines[:5]
        )

    def read(self, text: TraceText, options: TraceOptions) -> TraceSamples:
        """Round trips in the order of their sequence numbers; an answer that came twice counts once."""
        if options.column is not None:
            text.fail(f"no column {options.column!r}: ping output has none")
        if options.unit not in (None, "ms"):
            text.fail(f"unit {options.unit!r}: ping writes ms")
        answers = _Answers(text)
        for line, content in enumerate(text.lines, start=1):
            answers.take(line, content)
        provenance = text.lines[0].strip() if text.lines[0].startswith(("PING", "Pinging")) else "ping"
        samples = TraceSamples(options.kind or "round-trip", provenance=provenance[:200])
        if not answers.delays:
            return samples
        numbers = range(min(answers.delays), max(answers.delays) + 1)
        samples.delays = [answers.delays.get(n, math.nan) for n in numbers]
        samples.period = options.period or answers.period or None
        if len(answers.stamps) >= 2:
            samples.times, samples.period = _times(answers.stamps, numbers), None
        return samples


class _Answers:
    """What the lines say so far.

    Attributes:
        delays: round trips by sequence number (s); NaN: lost.
        stamps: instants of sending by sequence number (s), where they are printed.
        period: from the summary (s).
    """

    def __init__(self, text: TraceText) -> None:
        self.delays: dict[int, float] = {}
        self.stamps: dict[int, float] = {}
        self.period: float | None = None
        self._text = text
        self._newest = 0

    def take(self, line: int, content: str) -> None:
        """Read one line; raises TraceError for one that is almost, but not quite, an answer."""
        if found := _SUMMARY.search(content):
            sent = int(found.group(1))
            self.period = int(found.group(2)) * 1e-3 / (sent - 1) if sent > 1 else None
        elif found := (_LOST.search(content) or _UNREACHABLE.search(content)):
            self._newest = self._unwrap(int(found.group(1)), line)
            self.delays.setdefault(self._newest, math.nan)
        elif _WINDOWS_LOST.search(content):
            self._newest += 1
            self.delays[self._newest] = math.nan
        elif " time" in content and (found := _REPLY.match(content)):
            self._answer(found, line)
        elif "icmp_seq" in content or _ALMOST.match(content):
            self._text.fail(f"not a line of ping: {self._text.excerpt(line)}", line)

    def _answer(self, found: re.Match[str], line: int) -> None:
        stamp, sequence, word = found.groups()
        at = self._newest + 1 if sequence is None else self._unwrap(int(sequence), line)
        self._newest = max(self._newest, at)
        milliseconds = number(word.replace(",", "."), self._text, line, "a time in ms")
        delay = check_delay(milliseconds * 1e-3, self._text, line)
        if math.isnan(self.delays.get(at, math.nan)):
            self.delays[at] = delay
        if stamp is not None:
            self.stamps.setdefault(at, number(stamp, self._text, line, "a time stamp") - delay)

    def _unwrap(self, sequence: int, line: int) -> int:
        """The number without the 16-bit wrap-around, nearest to the newest one."""
        if sequence >= _SEQUENCE:
            self._text.fail(f"icmp_seq {sequence} is above 65535", line)
        turns = round((self._newest - sequence) / _SEQUENCE) if self._newest else 0
        return sequence + turns * _SEQUENCE


def _times(stamps: dict[int, float], numbers: range) -> list[float]:
    """Sending times; those of lost messages lie evenly between their neighbours'. Never decreasing."""
    known = sorted(stamps)
    step = (stamps[known[-1]] - stamps[known[0]]) / (known[-1] - known[0])
    times: list[float] = []
    before = 0
    for n in numbers:
        while before + 1 < len(known) and known[before + 1] <= n:
            before += 1
        anchor = known[before]
        if n > anchor and before + 1 < len(known):
            after = known[before + 1]
            share = (n - anchor) / (after - anchor)
            instant = stamps[anchor] + share * (stamps[after] - stamps[anchor])
        else:
            instant = stamps[anchor] + (n - anchor) * step
        times.append(max(instant, times[-1]) if times else instant)
    return times
