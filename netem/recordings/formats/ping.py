"""Output of `ping`: iputils of any age (also with -D and -O), BusyBox, BSD and macOS, Windows; in any language.

What is the same in every language is read: the sequence number, `= 12.3 ms`, and the counts of the summary. A line with
a number and no time is a lost message, whatever it says (no answer yet, unreachable, TTL exceeded, packet filtered,
fragmentation needed), save a redirect, which an answer follows. Numbers that no line tells of are lost too, and those
between the last line and the summary's count. Where answers have no numbers (Windows), every line between the first and
the statistics that is no answer is a lost message.

Sending times come from the time stamps of -D, else evenly from the summary's total time, else there are none. A second
run in the same file follows the first one.
"""

import math
import re
from dataclasses import dataclass, field
from itertools import islice
from typing import ClassVar

from farhand.netem.recordings.formats.base import (
    MAX_SAMPLES,
    TraceFormat,
    TraceOptions,
    TraceSamples,
    TraceText,
    check_delay,
    number,
)

_MS = r"(?:ms|мс|мсек|毫秒|ミリ秒)"
_TIME = re.compile(rf"[=<]\s*([0-9][0-9.,]{{0,23}}|[.,][0-9]{{1,22}})\s*{_MS}", re.IGNORECASE)
_NEGATIVE = re.compile(rf"=\s*-[0-9.,]+\s*{_MS}")
_SEQUENCE = re.compile(r"(?:icmp_seq|icmp_req|\bseq)\s?[= ]\s?(\d{1,9})(?!\d)")
_STAMP = re.compile(r"\[([0-9.]{1,24})\]\s")
_ANSWER_MARK = re.compile(r"\bttl\b|\bhlim\b|\bbytes\b|\boctets?\b", re.IGNORECASE)
_SUMMARY = re.compile(r"(\d{1,9})\s[^%\d]{1,60}(\d{1,9})\s[^%]{1,80}?\d\s?%")
_TOTAL_TIME = re.compile(rf"%.*?\s(\d{{1,12}})\s*{_MS}\s*\Z")
_WINDOWS_COUNTS = re.compile(r"=\s?(\d{1,9})\b[^=]*=\s?(\d{1,9})\b[^=]*=\s?(\d{1,9})(?!\s?\d|\s?ms)")
_HEADER = re.compile(r"PING6?[ (]|Pinging |HPING ")
_WINDOWS_ANSWER = re.compile(rf"\A[^\[=]*?[:：].*[=<]\s*[0-9.,]+\s*{_MS}", re.IGNORECASE)
_ONE_OF_MINE = re.compile(r"\A(?:\[[0-9.]+\]\s)?\d+\s\w+\s\w")
_ICMP_ERROR = re.compile(
    r"nreachable|xceeded|edirect|filtered|uench|rohibited|[Ff]rag|needed|nvalid|TTL expired|time to live",
    re.IGNORECASE,
)
_KNOWN_LOSS = re.compile(
    r"timed out|timeout|General failure|transmit failed|nreachable|TTL expired|expired|filtered|needs to be fragmented|"
    r"Zeitüberschreitung|nicht erreichbar|allgemeiner Fehler|Délai|dépassé|inaccessible|agotado|inaccesible|scaduta|"
    r"Превышен|недоступен|超时|無法|无法",
    re.IGNORECASE,
)
_SHELL = re.compile(
    r"\A(?:[A-Z]:\\|PS |\^C|Control-C|Strg-C|Microsoft |\(c\)|\$|#|.*[>$#] ?ping )", re.IGNORECASE
)
_TURN = 1 << 16
_REORDERED = 1000
"""A number so far below the newest one is a new run's, not a late answer's."""


class Ping(TraceFormat):
    """Output of ping."""

    name: ClassVar[str] = "ping"

    def matches(self, text: TraceText) -> bool:
        """Whether the beginning looks like a ping; it may be long, of a log that begins in an outage."""
        return any(
            _HEADER.match(line)
            or (_TIME.search(line) and (_SEQUENCE.search(line) or _ANSWER_MARK.search(line)))
            or (_SEQUENCE.search(line) and ("answer" in line or "timeout" in line))
            for line in islice(text.lines, 1000)
        )

    def read(self, text: TraceText, options: TraceOptions) -> TraceSamples:
        """Round trips in the order of their sequence numbers; an answer that came twice counts once."""
        if options.column is not None:
            text.fail(f"no column {options.column!r}: ping output has none")
        if options.unit not in (None, "ms"):
            text.fail(f"unit {options.unit!r}: ping writes ms")
        text.how("unit", "ms (as ping writes)")
        text.how("kind", f"{options.kind} (as said)" if options.kind else "round-trip (as ping measures)")
        reader = _Reader(text)
        for line, content in enumerate(text.lines, start=1):
            reader.take(line, content)
        return reader.samples(options)


@dataclass
class _Run:
    """One call of ping.

    Attributes:
        line: where it begins.
        first: the number that it begins with, if that is known.
        delays: round trips by number (s); NaN: the log says that it is lost.
        stamps: instants of sending by number (s), where they are printed.
        unknown: numbers given to lines that were not understood.
        period: from the summary (s).
        newest: number.
        has_numbers: whether answers are numbered, as they are everywhere but on Windows.
        ended: the summary has come.
    """

    line: int
    first: int | None = None
    delays: dict[int, float] = field(default_factory=dict)
    stamps: dict[int, float] = field(default_factory=dict)
    unknown: list[int] = field(default_factory=list)
    sent: int | None = None
    period: float | None = None
    newest: int = 0
    has_numbers: bool | None = None
    ended: bool = False

    def numbers(self) -> range:
        """From the first to the last message that is known of."""
        if not self.delays:
            return range(0)
        low, high = min(self.delays), max(self.delays)
        if self.first is not None and self.first < low:
            low = self.first
        if self.sent is not None and self.first is not None:
            high = max(high, self.first + self.sent - 1)
        return range(low, high + 1)


class _Reader:
    """What the lines say so far, run by run."""

    def __init__(self, text: TraceText) -> None:
        self._text = text
        self._runs = [_Run(1)]
        self._upper_bounds = 0

    def take(self, line: int, content: str) -> None:
        """Read one line; raises TraceError for one that is almost, but not quite, an answer."""
        run, stripped = self._runs[-1], content.strip()
        if not stripped:
            return
        if self._is_header(stripped, run):
            self._begin(line, stripped)
        elif self._is_summary(stripped, run):
            run.ended = True
        elif (found := _SEQUENCE.search(content)) is not None:
            self._numbered(int(found.group(1)), line, content)
        elif _WINDOWS_ANSWER.match(content) and not run.has_numbers and len(_TIME.findall(content)) == 1:
            self._unnumbered(line, content)
        elif self._text.cut_off_at(line):
            self._text.say_cut_off(line)
        elif (
            _ONE_OF_MINE.match(content)
            and not _ICMP_ERROR.search(content)
            and not run.ended
            and ":" in content
        ):
            self._text.fail(f"not a line of ping: {self._text.excerpt(line)}", line)
        elif not run.has_numbers and not run.ended:
            self._without_number(line, stripped)

    def _is_header(self, stripped: str, run: _Run) -> bool:
        if _HEADER.match(stripped) and not stripped.startswith(("PING: ", "Ping: ")):
            return True
        # Windows in another language: a line that ends with a colon before any answer, or after the statistics.
        is_title = stripped.endswith((":", "：")) and bool(re.search(r"\b\d{1,5}\b[^:]*[:：]\Z", stripped))
        return is_title and (run.ended or not run.delays) and not run.has_numbers

    def _begin(self, line: int, header: str) -> None:
        if self._runs[-1].delays:
            self._runs.append(_Run(line))
        run = self._runs[-1]
        if re.search(r"\d+\(\d+\)", header) or (header.startswith("PING") and " data bytes" not in header):
            run.first = 1 if re.search(r"\d+\(\d+\)", header) else None
        elif " data bytes" in header:
            run.first = 0
        if header.startswith("Pinging"):
            run.has_numbers = False

    def _is_summary(self, stripped: str, run: _Run) -> bool:
        is_answer = _SEQUENCE.search(stripped) or _ANSWER_MARK.search(stripped)
        if not (run.has_numbers or is_answer) and (found := _WINDOWS_COUNTS.search(stripped)):
            self._check_counts(run, int(found.group(1)), int(found.group(3)))
            return True
        if found := _SUMMARY.search(stripped):
            run.sent = int(found.group(1))
            total = _TOTAL_TIME.search(stripped)
            if total is not None and run.sent > 1:
                run.period = int(total.group(1)) * 1e-3 / (run.sent - 1)
            return True
        return stripped.startswith("---") or (len(_TIME.findall(stripped)) > 1)

    def _check_counts(self, run: _Run, sent: int, lost: int) -> None:
        counted = sum(math.isnan(delay) for delay in run.delays.values())
        # A line that was not understood is no message if there are too many by just such lines. Windows counts an
        # answer of a router (unreachable) as received, so that its count of lost ones proves less.
        if run.unknown and len(run.delays) - len(run.unknown) == sent:
            for at in run.unknown:
                del run.delays[at]
            # What is left keeps its order; numbers only have to follow one another.
            run.delays = dict(enumerate(run.delays.values(), start=1))
            run.unknown = []
        elif counted != lost or len(run.delays) != sent:
            self._text.say(
                f"the statistics say {sent} sent, {lost} lost; the lines before tell of {len(run.delays)} and {counted}"
            )

    def _numbered(self, sequence: int, line: int, content: str) -> None:
        time = _TIME.search(content)
        run = self._runs[-1]
        if time is None:
            if _NEGATIVE.search(content):
                self._text.fail(f"not a line of ping: {self._text.excerpt(line)}", line)
            if self._text.cut_off_at(line):
                self._text.say_cut_off(line)
                return
            if "edirect" in content:
                self._text.say("redirects are no losses: the answer follows")
                return
            if (_ONE_OF_MINE.match(content) and not _ICMP_ERROR.search(content)) or "ttl=" in content:
                self._text.fail(f"not a line of ping: {self._text.excerpt(line)}", line)
        run = self._run_of(sequence, line, content)
        run.has_numbers = True
        at = self._unwrap(run, sequence, line)
        run.newest = max(run.newest, at)
        if time is None:
            run.delays.setdefault(at, math.nan)
            return
        self._answer(run, at, time, line, content)

    def _unnumbered(self, line: int, content: str) -> None:
        run = self._runs[-1]
        if run.ended:
            run = _Run(line, has_numbers=False)
            self._runs.append(run)
        run.has_numbers = False
        time = _TIME.search(content)
        run.newest += 1
        if time is not None:
            self._answer(run, run.newest, time, line, content)

    def _without_number(self, line: int, stripped: str) -> None:
        """A line of Windows that is no answer."""
        run = self._runs[-1]
        if _SHELL.match(stripped) or (stripped.endswith((":", "：")) and not _KNOWN_LOSS.search(stripped)):
            return
        known = bool(_KNOWN_LOSS.search(stripped))
        if run.has_numbers is None and not known:
            return
        run.newest += 1
        run.delays[run.newest] = math.nan
        if not known:
            run.unknown.append(run.newest)
            self._text.say(
                f"line {line} is no answer of ping, and taken for a lost message: {stripped[:60]!r}"
            )

    def _answer(self, run: _Run, at: int, time: re.Match[str], line: int, content: str) -> None:
        milliseconds = number(time.group(1).replace(",", "."), self._text, line, "a time in ms")
        delay = check_delay(milliseconds * 1e-3, self._text, line)
        if time.group().startswith("<"):
            self._text.say("answers that say <1 ms are read as 1 ms")
        if math.isnan(run.delays.get(at, math.nan)):
            run.delays[at] = delay
        stamp = _STAMP.match(content)
        if stamp is not None:
            run.stamps.setdefault(at, number(stamp.group(1), self._text, line, "a time stamp") - delay)

    def _run_of(self, sequence: int, line: int, content: str) -> _Run:
        """The run that a number belongs to: a new one where counting starts again without a header."""
        run = self._runs[-1]
        at = self._unwrap(run, sequence, line)
        restarts = sequence <= 1 and at < run.newest - 1 and at in run.delays and "DUP" not in content
        if run.delays and (run.ended or at < run.newest - _REORDERED or restarts):
            run = _Run(line)
            self._runs.append(run)
        return run

    def _unwrap(self, run: _Run, sequence: int, line: int) -> int:
        """The number without the 16-bit wrap-around, nearest to the newest one."""
        if sequence >= _TURN:
            self._text.fail(f"icmp_seq {sequence} is above 65535", line)
        turns = round((run.newest - sequence) / _TURN) if run.newest else 0
        return sequence + turns * _TURN

    def samples(self, options: TraceOptions) -> TraceSamples:
        """All runs, one after the other."""
        runs = [run for run in self._runs if run.delays]
        head = self._text.lines[0].strip()
        samples = TraceSamples(
            options.kind or "round-trip",
            provenance=(head if _HEADER.match(head) else "ping")[:200],
            rows_missing="none",
        )
        if len(runs) > 1:
            where = ", ".join(str(run.line) for run in runs[:10])
            self._text.say(f"{len(runs)} runs of ping, one after the other, that begin at lines {where}")
        times: list[float] = []
        pauses: list[int] = []
        for run in runs:
            numbers = run.numbers()
            if len(samples.delays) + len(numbers) > MAX_SAMPLES:
                self._text.fail(f"numbers from {numbers.start} to {numbers.stop - 1}: too many messages")
            pauses.append(len(samples.delays))
            samples.delays += [run.delays.get(n, math.nan) for n in numbers]
            samples.inferred += sum(n not in run.delays for n in numbers)
            if len(run.stamps) >= 2:
                times += _times(run.stamps, numbers)
        samples.pauses = tuple(pauses[1:])
        if times and len(times) == len(samples.delays):
            samples.times = times
            self._text.how("times", "the time stamps of -D")
            return samples
        periods = [run.period for run in runs if run.period]
        samples.period = options.period or (periods[0] if periods else None)
        if options.period is None and periods:
            self._text.how("times", f"one every {periods[0] * 1e3:g} ms, by the summary")
        elif samples.period is None:
            self._text.how("times", "none; say period=1000 (--period) if one was sent each second")
        return samples


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
