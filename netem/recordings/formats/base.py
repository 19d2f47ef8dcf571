"""What every trace format shares: its interface, the samples it yields, how a bad line is reported, units.

To add a format: one file with a `TraceFormat` (name, matches, read), and one line in registry.py; or, from a
package of your own, an entry point of the group `farhand.trace_formats`.
"""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import ClassVar, Literal, NoReturn, get_args

from farhand.common.errors import TraceError

Kind = Literal["one-way", "round-trip"]
KINDS: tuple[Kind, ...] = get_args(Kind)

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
    """

    unit: str | None = None
    column: str | None = None
    period: float | None = None
    kind: Kind | None = None


@dataclass
class TraceSamples:
    """What a reader found.

    Attributes:
        delays: s; NaN where the message was lost.
        times: instant of sending of each (s, increasing, any origin), or None.
        period: of evenly spaced samples (s), or None.
        kind: what a delay spans.
        provenance: where the recording comes from, as far as the file says; empty otherwise.
    """

    kind: Kind
    delays: list[float] = field(default_factory=list)
    times: list[float] | None = None
    period: float | None = None
    provenance: str = ""


@dataclass(frozen=True)
class TraceText:
    """A text file cut into lines.

    Attributes:
        name: as the user wrote it, for messages.
        lines: without line ends; lines[0] is line 1.
    """

    name: str
    lines: list[str]

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
        text.fail(f"the delay is negative: {text.excerpt(line)}", line)
    if delay > LONGEST_DELAY:
        text.fail(f"a delay of {delay:.6g} s is more than an hour; is the unit right?", line)
    return delay


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


def kind_in(header: dict[str, str], options: TraceOptions, text: TraceText) -> Kind | None:
    """The kind that the caller says, or the file's header; None without one."""
    if options.kind is not None:
        return options.kind
    stated = header.get("kind")
    if stated is None:
        return None
    if stated == "one-way":
        return "one-way"
    if stated == "round-trip":
        return "round-trip"
    text.fail(f"kind {stated!r} in the header; one-way or round-trip")


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
