"""Output of `fping`: with -c or -l a line for each message, with -C a line for each host.

    8.8.8.8 : [0], 84 bytes, 12.3 ms (12.3 avg, 0% loss)          fping -l, -c (with -D after "[1700000000.1] ")
    8.8.8.8 : [1], timed out (12.3 avg, 50% loss)
    8.8.8.8 : 12.3 - 13.1 11.9                                    fping -C; "-" is a lost message

Of several hosts, `column` says which. Several runs in one log (after the statistics, or where the numbers start again)
follow one another; what lies between them is no silence of the network.
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
_ENDED = re.compile(r"\A(\S+)\s+: xmt/rcv/%loss = ")
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
            elif ended := _ENDED.match(content):
                found.setdefault(ended.group(1), _Host()).ended = True
            elif text.cut_off_at(line):
                text.say_cut_off(line)
        name, host = _chosen(found, options, text)
        text.how("column", f"host {name}")
        text.how("unit", "ms (as fping writes)")
        text.how("kind", f"{options.kind} (as said)" if options.kind else "round-trip (as fping measures)")
        return _samples(name, host, options, text)


def _samples(name: str, host: "_Host", options: TraceOptions, text: TraceText) -> TraceSamples:
    """All runs of a host, one after the other."""
    samples = TraceSamples(
        options.kind or "round-trip", period=options.period, provenance=f"fping {name}", rows_missing="none"
    )
    runs = [run for run in host.runs if run.delays]
    if len(runs) > 1:
        where = ", ".join(str(run.line) for run in runs[:10])
        text.say(f"{len(runs)} runs of fping, one after the other, that begin at lines {where}")
    times: list[float] = []
    pauses: list[int] = []
    for run in runs:
        numbers = run.numbers()
        pauses.append(len(samples.delays))
        samples.delays += [run.delays.get(n, math.nan) for n in numbers]
        samples.inferred += sum(n not in run.delays for n in numbers)
        times += [run.stamps[n] for n in numbers if n in run.stamps]
    samples.pauses = tuple(pauses[1:])
    if len(times) == len(samples.delays):
        samples.times, samples.period = times, None
        text.how("times", "the time stamps of -D")
    elif options.period is None:
        text.how("times", "none; say period=1000 (--period) if one was sent each second")
    return samples


class _Run:
    """One call of fping: delays and instants of sending (s) by number.

    Args:
        line: where it begins.
    """

    def __init__(self, line: int) -> None:
        self.line = line
        self.delays: dict[int, float] = {}
        self.stamps: dict[int, float] = {}

    def numbers(self) -> range:
        """From the first message on, which has number 0, to the last that is known of."""
        return range(max(self.delays) + 1)


class _Host:
    """The runs of one host.

    Attributes:
        runs: in order.
        ended: the statistics of the last one have come.
    """

    def __init__(self) -> None:
        self.runs: list[_Run] = []
        self.ended = False

    @property
    def delays(self) -> bool:
        """Whether there are any."""
        return any(run.delays for run in self.runs)

    def begin(self, line: int) -> _Run:
        """A new run."""
        self.runs.append(_Run(line))
        self.ended = False
        return self.runs[-1]

    def run_of(self, at: int, line: int) -> _Run:
        """The run that a number belongs to: a new one after the statistics, or where a number comes again."""
        if not self.runs or self.ended:
            return self.begin(line)
        run = self.runs[-1]
        answered = not math.isnan(run.delays.get(at, math.nan))
        # The first message of another run, even if that of this one was lost.
        starts_again = at == 0 and at in run.delays and len(run.delays) > 1
        return self.begin(line) if answered or starts_again else run


def _take_each(host: _Host, found: re.Match[str], text: TraceText, line: int) -> None:
    stamp, at, rest = found.group(1), int(found.group(3)), found.group(4)
    if at > 4_000_000:
        text.fail(f"the number is too high: {text.excerpt(line)}", line)
    time = _TIME.search(rest)
    if time is None and text.cut_off_at(line):
        text.say_cut_off(line)
        return
    delay = math.nan
    if time is not None:
        delay = check_delay(number(time.group(1), text, line, "a time in ms") * 1e-3, text, line)
    elif "timed out" not in rest and "nreachable" not in rest and "xceeded" not in rest:
        text.fail(f"not a line of fping: {text.excerpt(line)}", line)
    run = host.run_of(at, line)
    run.delays[at] = delay
    if stamp is not None:
        instant = number(stamp, text, line, "a time stamp")
        run.stamps.setdefault(at, instant if math.isnan(delay) else instant - delay)


def _take_row(host: _Host, words: list[str], text: TraceText, line: int) -> None:
    if text.cut_off_at(line):
        text.say_cut_off(line)
        words = words[:-1]
    run = host.begin(line)
    for at, word in enumerate(words):
        is_lost = word == "-"
        run.delays[at] = (
            math.nan if is_lost else check_delay(number(word, text, line, "ms") * 1e-3, text, line)
        )


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
