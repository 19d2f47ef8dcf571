"""What every trace format shares: its interface, the samples it yields, how a bad line is reported, units.

To add a format: one file with a `TraceFormat` (name, matches, read), and one line in registry.py; or, from a
package of your own, an entry point of the group `farhand.trace_formats`.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import ClassVar, Literal, NoReturn, get_args

from farhand.common.errors import TraceError

Kind = Literal["one-way", "round-trip"]
KINDS: tuple[Kind, ...] = get_args(Kind)
Decimal = Literal["comma", "point"]
DECIMALS: tuple[Decimal, ...] = get_args(Decimal)

UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "ns": 1e-9}
"""Units of time that a trace may use, in s.

Delays are multiplied by them and not divided by 1e9, as `to_seconds` does: that differs in the last bit, and so might
a nanosecond of a replay.
"""

MAX_SAMPLES = 2_000_000
LONGEST_DELAY = 3600.0
"""A delay beyond an hour (s) is a mistaken unit, not a network."""


@dataclass(frozen=True)
class TraceOptions:
    """What the caller says about a file; None where the file or the format says it.

    Attributes:
        unit: of the delays, a key of UNITS.
        column: name of the delay's column, or its number counted from 1.
        period: length of a slot (s).
        kind: "one-way" or "round-trip".
        time_unit: of the times, a key of UNITS.
        decimal: "comma" or "point", for numbers such as 1,234 that can be read in two ways.
        lost: how the file writes a lost message, such as 0 or -1; "none": a delay of 0 is a delay.
        sort: whether rows out of order are put in order.
    """

    unit: str | None = None
    column: str | None = None
    period: float | None = None
    kind: Kind | None = None
    time_unit: str | None = None
    decimal: Decimal | None = None
    lost: str | None = None
    sort: bool = False


@dataclass
class Reading:
    """How a file was read, for whoever has to judge whether that is right.

    Attributes:
        how: what (format, column, unit, kind, ...) and how it was read, and why so.
        notes: what was assumed, left out or not understood, one line each.
        lost_seen: lost messages that the file says.
        lost_inferred: lost messages that only gaps in its times or numbers tell of.
    """

    how: dict[str, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    lost_seen: int = 0
    lost_inferred: int = 0


@dataclass
class TraceSamples:
    """What a reader found.

    Attributes:
        delays: s; NaN where the message was lost.
        times: instant of sending of each (s, increasing, any origin), or None.
        period: of evenly spaced samples (s), or None.
        kind: what a delay spans.
        provenance: where the recording comes from, as far as the file says; empty otherwise.
        rows_missing: what rows that are not there mean: "lost"; "none", every message has a row; or "unknown",
            which is judged by the times.
        inferred: how many of the lost ones the file does not say, but its numbering does.
        pauses: indices before which the recording paused, whatever the times say.
        lines: the line of each, for errors.
    """

    kind: Kind
    delays: list[float] = field(default_factory=list)
    times: list[float] | None = None
    period: float | None = None
    provenance: str = ""
    rows_missing: Literal["lost", "none", "unknown"] = "unknown"
    inferred: int = 0
    pauses: tuple[int, ...] = ()
    lines: list[int] | None = None


@dataclass(frozen=True)
class TraceText:
    """A text file cut into lines.

    Attributes:
        name: as the user wrote it, for messages.
        lines: without line ends; lines[0] is line 1. The last is empty where the file ends with a line end.
        reading: how it was read, as far as its format has told (`text.say`, `text.how`).
    """

    name: str
    lines: Sequence[str]
    reading: Reading = field(default_factory=Reading, compare=False)

    def how(self, what: str, value: str) -> None:
        """Note how something was read, such as the unit."""
        self.reading.how[what] = value

    def say(self, note: str) -> None:
        """Note, once, what was assumed, left out or not understood."""
        if note not in self.reading.notes:
            self.reading.notes.append(note)

    def cut_off_at(self, line: int) -> bool:
        """Whether a line is the last one and has no line end, so that its end may be missing."""
        return line == len(self.lines) and bool(self.lines[-1].strip())

    def say_cut_off(self, line: int) -> None:
        """Note that the last line was left out."""
        self.say(f"line {line}, the last, has no line end and may be cut off: left out")

    def fail(self, problem: str, line: int | None = None) -> NoReturn:
        """Raise a TraceError of one line that names the file and, if given, the line's number."""
        place = f"{self.name}, line {line}" if line else self.name
        raise TraceError(f"trace {place}: {' '.join(problem.split())}")

    def excerpt(self, line: int) -> str:
        """The line in quotes, cut to a readable length."""
        text = self.lines[line - 1]
        return repr(text if len(text) <= 40 else text[:37] + "...")


class TraceFormat(ABC):
    """A format of recorded delays.

    Class attributes:
        name: in `--format` and in a SPEC's `format=`.
        general: many files look like it, so it is asked after those that look for something particular.
    """

    name: ClassVar[str]
    general: ClassVar[bool] = False

    @abstractmethod
    def matches(self, text: TraceText) -> bool:
        """Whether a text, which is not empty, looks like it."""

    @abstractmethod
    def read(self, text: TraceText, options: TraceOptions) -> TraceSamples:
        """Its samples; raises TraceError (`text.fail`) with the line and what is wrong with it."""


def factor_of(unit: str, text: TraceText) -> float:
    """One `unit` in s; raises TraceError for one that is unknown."""
    if unit not in UNITS:
        text.fail(f"unknown unit {unit!r}; one of {', '.join(UNITS)}")
    return UNITS[unit]


def check_delay(delay: float, text: TraceText, line: int) -> float:
    """The delay itself (s); raises TraceError unless it is finite, not negative, and below an hour."""
    if not math.isfinite(delay):
        text.fail(f"the delay is not a finite number: {text.excerpt(line)}", line)
    if delay < 0:
        text.fail(
            f"the delay is negative: {text.excerpt(line)} (if that is a lost message, say so: lost=-1, --lost -1)",
            line,
        )
    if delay > LONGEST_DELAY:
        text.fail(f"a delay of {delay:.6g} s is more than an hour; is the unit right?", line)
    return delay


ZERO_ASKED = "a delay of 0: a lost message? Say lost=0 (--lost 0), or lost=none if it is a delay"


def is_lost(word: str, lost: str | None) -> bool:
    """Whether a word is the one that the caller says for a lost message."""
    if lost is None or lost == "none":
        return False
    try:
        return float(word) == float(lost)
    except ValueError:
        return word.lower() == lost.lower()


def number(word: str, text: TraceText, line: int, what: str) -> float:
    """`word` as a finite float; raises TraceError that says what was expected."""
    try:
        # Python's float takes more than a number in a file may be: 1_000, and digits of other scripts.
        value = float(word) if word.isascii() and "_" not in word else math.nan
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        text.fail(f"expected {what}, got {text.excerpt(line)}", line)
    return value


def comments(text: TraceText) -> dict[str, str]:
    """The `# key: value` lines at the head of a file, keys in lower case."""
    found: dict[str, str] = {}
    for line in text.lines:
        if not line.startswith("#"):
            break
        key, separator, value = line.lstrip("#").partition(":")
        if separator:
            found[key.strip().lower()] = value.strip()
    return found


def kind_in(
    header: dict[str, str], options: TraceOptions, text: TraceText, named: Kind | None = None
) -> Kind:
    """The kind that the caller says, or the file's header, or its column's name; one-way, said aloud, without."""
    stated = header.get("kind")
    if options.kind is not None:
        text.how("kind", f"{options.kind} (as said)")
        return options.kind
    for known in KINDS:
        if stated == known:
            text.how("kind", f"{known} (the header)")
            return known
    if stated is not None:
        text.fail(f"kind {stated!r} in the header; one-way or round-trip")
    if named is not None:
        text.how("kind", f"{named} (the column's name)")
        return named
    text.how("kind", "one-way (assumed)")
    text.say("the file does not say what its delays span; one-way is assumed: else kind=round-trip (--kind)")
    return "one-way"


def period_in(header: dict[str, str], options: TraceOptions, text: TraceText) -> float | None:
    """The spacing of the samples (s) that the caller says, or the file's header; None without one."""
    if options.period is not None or "period" not in header:
        return options.period
    return duration_in(header["period"], text, "period")


def duration_in(word: str, text: TraceText, what: str) -> float:
    """A duration with its unit, such as "10 ms", in s; raises TraceError otherwise."""
    stripped = word.strip()
    for unit in sorted(UNITS, key=len, reverse=True):
        if stripped.endswith(unit):
            try:
                value = float(stripped[: -len(unit)]) * UNITS[unit]
            except ValueError:
                break
            if math.isfinite(value) and value > 0:
                return value
            break
    text.fail(f"{what} {word!r} is not a positive duration with a unit, such as 10 ms")
