"""Output of `ping`: iputils (also with -D and -O), BSD and macOS, Windows.

Missing sequence numbers and time-outs are lost messages. Sending times come from the time stamps of -D,
else evenly from the summary's total time, else there are none.
"""

import math
import re

from farhand.netem.recordings.formats.base import ReadOptions, Samples, TraceText, check_delay, number

_REPLY = re.compile(
    r"(?:\[([0-9.]{1,24})\] )?.*?(?:icmp_seq[= ](\d{1,9})\b.*?)?\btime[=<]\s*([0-9.,]{1,24})\s*ms"
)
_LOST = re.compile(r"(?:no answer yet for|Request timeout for) icmp_seq[= ](\d{1,9})")
_UNREACHABLE = re.compile(r"icmp_seq[= ](\d{1,9}) .*(?:nreachable|exceeded)")
_SUMMARY = re.compile(r"(\d{1,9}) packets transmitted.*\btime (\d{1,12})\s*ms")
_WINDOWS_LOST = re.compile(r"Request timed out\.?\s*\Z")
_SEQUENCE = 1 << 16


def matches(text: TraceText) -> bool:
    """Whether the beginning looks like a ping."""
    return any(
        line.startswith(("PING ", "PING6", "Pinging ")) or ("time=" in line and "ms" in line)
        for line in text.lines[:5]
    )


def read(text: TraceText, options: ReadOptions) -> Samples:
    """Round trips in the order of their sequence numbers; an answer that came twice counts once."""
    if options.column is not None:
        text.fail(f"no column {options.column!r}: ping output has none")
    if options.unit not in (None, "ms"):
        text.fail(f"unit {options.unit!r}: ping writes ms")
    delays: dict[int, float] = {}
    stamps: dict[int, float] = {}
    newest, total = 0, None
    for line, content in enumerate(text.lines, start=1):
        if found := _SUMMARY.search(content):
            sent = int(found.group(1))
            total = int(found.group(2)) * 1e-3 / (sent - 1) if sent > 1 else None
        elif found := (_LOST.search(content) or _UNREACHABLE.search(content)):
            newest = _unwrap(int(found.group(1)), newest, text, line)
            delays.setdefault(newest, math.nan)
        elif _WINDOWS_LOST.search(content):
            newest += 1
            delays[newest] = math.nan
        elif " time" in content and (found := _REPLY.match(content)):
            stamp, sequence, word = found.groups()
            at = newest + 1 if sequence is None else _unwrap(int(sequence), newest, text, line)
            newest = max(newest, at)
            delay = check_delay(number(word.replace(",", "."), text, line, "a time in ms") * 1e-3, text, line)
            if math.isnan(delays.get(at, math.nan)):
                delays[at] = delay
            if stamp is not None:
                stamps.setdefault(at, number(stamp, text, line, "a time stamp") - delay)
        elif "icmp_seq" in content or re.match(r"\d+ bytes from|Reply from", content):
            text.fail(f"not a line of ping: {text.excerpt(line)}", line)
    provenance = text.lines[0].strip() if text.lines[0].startswith(("PING", "Pinging")) else "ping"
    samples = Samples(options.kind or "round-trip", provenance=provenance[:200])
    if not delays:
        return samples
    first = min(delays)
    numbers = range(first, max(delays) + 1)
    samples.delays = [delays.get(n, math.nan) for n in numbers]
    samples.period = options.period or total or None
    if len(stamps) >= 2:
        samples.times, samples.period = _times(stamps, numbers), None
    return samples


def _unwrap(sequence: int, newest: int, text: TraceText, line: int) -> int:
    """The number without the 16-bit wrap-around, nearest to the newest one."""
    if sequence >= _SEQUENCE:
        text.fail(f"icmp_seq {sequence} is above 65535", line)
    turns = round((newest - sequence) / _SEQUENCE) if newest else 0
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
