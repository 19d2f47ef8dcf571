"""Output of `fping`: with -c or -l a line for each message, with -C a line for each host.

    8.8.8.8 : [0], 84 bytes, 12.3 ms (12.3 avg, 0% loss)          fping -l, -c (with -D after "[1700000000.1] ")
    8.8.8.8 : [1], timed out (12.3 avg, 50% loss)
    8.8.8.8 : 12.3 - 13.1 11.9                                    fping -C; "-" is a lost message

Of several hosts, `column` says which.
"""

import math
import re
from itertools import islice
from typing import ClassVar

from farhand.netem.recordings.formats.base import (
    TraceFormat,
    TraceOptions,
    TraceSamples,
    TraceText,
    check_delay,
    number,
)

_EACH = re.compile(r"\A(?:\[([0-9.]{1,24})\]\s)?(\S+)\s+: \[(\d{1,9})\], (.*)\Z")
_ROW = re.compile(r"\A(\S+)\s+:((?: (?:\d+(?:\.\d+)?|-))+)\s*\Z")
_TIME = re.compile(r"([0-9.]{1,24}) ms\b")


class Fping(TraceFormat):
    """Output of fping."""

    name: ClassVar[str] = "fping"

    def matches(self, text: TraceText) -> bool:
        """Whether one of the first lines is an answer, or a row of answers."""
        return any(_EACH.match(line) or _ROW.match(line) for line in islice(text.lines, 1000))

    def read(self, text: TraceText, options: TraceOptions) -> TraceSamples:
        """Round trips to one host, in the order of their numbers."""
        if options.unit not in (None, "ms"):
            text.fail(f"unit {options.unit!r}: fping writes ms")
        found: dict[str, _Host] = {}
        for line, content in enumerate(text.lines, start=1):
            if each := _EACH.match(content):
                _take_each(found.setdefault(each.group(2), _Host()), each, text, line)
            elif row := _ROW.match(content):
                _take_row(found.setdefault(row.group(1), _Host()), row.group(2).split(), text, line)
            elif text.cut_off_at(line):
                text.say_cut_off(line)
        name, host = _chosen(found, options, text)
        text.how("column", f"host {name}")
        text.how("unit", "ms (as fping writes)")
        text.how("kind", f"{options.kind} (as said)" if options.kind else "round-trip (as fping measures)")
        numbers = range(min(0, *host.delays), max(host.delays) + 1)
        samples = TraceSamples(
            options.kind or "round-trip",
            [host.delays.get(n, math.nan) for n in numbers],
            period=options.period,
            provenance=f"fping {name}",
            rows_missing="none",
            inferred=sum(n not in host.delays for n in numbers),
        )
        if len(host.stamps) == len(numbers):
            samples.times = [host.stamps[n] for n in numbers]
            samples.period = None
            text.how("times", "the time stamps of -D")
        elif options.period is None:
            text.how("times", "none; say period=1000 (--period) if one was sent each second")
        return samples


class _Host:
    """Delays and instants of sending (s) by number."""

    def __init__(self) -> None:
        self.delays: dict[int, float] = {}
        self.stamps: dict[int, float] = {}


def _take_each(host: _Host, found: re.Match[str], text: TraceText, line: int) -> None:
    stamp, at, rest = found.group(1), int(found.group(3)), found.group(4)
    if at > 4_000_000 or at < len(host.delays) - 1000:
        text.fail(
            f"the numbers start again or are too high: {text.excerpt(line)}; cut the file into its runs", line
        )
    time = _TIME.search(rest)
    if time is None and text.cut_off_at(line):
        text.say_cut_off(line)
        return
    delay = math.nan
    if time is not None:
        delay = check_delay(number(time.group(1), text, line, "a time in ms") * 1e-3, text, line)
    elif "timed out" not in rest and "nreachable" not in rest and "xceeded" not in rest:
        text.fail(f"not a line of fping: {text.excerpt(line)}", line)
    if math.isnan(host.delays.get(at, math.nan)):
        host.delays[at] = delay
    if stamp is not None:
        instant = number(stamp, text, line, "a time stamp")
        host.stamps.setdefault(at, instant if math.isnan(delay) else instant - delay)


def _take_row(host: _Host, words: list[str], text: TraceText, line: int) -> None:
    if text.cut_off_at(line):
        text.say_cut_off(line)
        words = words[:-1]
    at = len(host.delays)
    for word in words:
        is_lost = word == "-"
        host.delays[at] = (
            math.nan if is_lost else check_delay(number(word, text, line, "ms") * 1e-3, text, line)
        )
        at += 1


def _chosen(found: dict[str, "_Host"], options: TraceOptions, text: TraceText) -> tuple[str, _Host]:
    found = {name: host for name, host in found.items() if host.delays}
    if not found:
        text.fail("no samples")
    if options.column is not None:
        if options.column not in found:
            text.fail(f"no host {options.column!r}; there are {', '.join(found)}")
        return options.column, found[options.column]
    if len(found) > 1:
        text.fail(
            f"several hosts; say which: column={next(iter(found))} (--column), or one of {', '.join(found)}"
        )
    return next(iter(found.items()))
