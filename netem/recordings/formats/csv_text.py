"""Comma-separated values, our own format first of all.

    # farhand trace
    # unit: ms
    # kind: round-trip
    # provenance: robot lab to server room, 50 messages a second of 300 bytes
    time,delay
    0.000,15.2
    0.020,lost

`time` is in s unless its name says otherwise (`time(ms)`, `time_ms`); `delay` is in the header's unit.
A delay that is empty, `lost` or `nan` is a lost message. Other CSV files are read with a `column` and
a `unit` (the column's name may hold it: `rtt(ms)`, `rtt_ms`).
"""

import csv
import math
import re
from io import StringIO
from typing import ClassVar

from farhand.netem.recordings.formats.base import (
    UNITS,
    TraceFormat,
    TraceOptions,
    TraceSamples,
    TraceText,
    check_delay,
    comments,
    factor_of,
    kind_in,
    number,
    period_in,
)

MARK = "# farhand trace"
_DELAY_NAMES = ("delay", "rtt", "latency")
_TIME_NAMES = ("time", "t", "timestamp")
_LOST = {"", "lost", "nan", "none", "null", "inf"}
_UNIT_IN_NAME = re.compile(r"(.+?)\s*(?:\((\w+)\)|\[(\w+)\]|_(s|ms|us|ns))\Z")


class CsvText(TraceFormat):
    """Comma-separated values."""

    name: ClassVar[str] = "csv"
    general: ClassVar[bool] = True

    def matches(self, text: TraceText) -> bool:
        """Whether this looks like comma-separated values."""
        if text.lines[0].lower().startswith(MARK):
            return True
        first = next((line for line in text.lines if line.strip() and not line.startswith("#")), "")
        return "," in first or first.strip().lower().startswith(_DELAY_NAMES)

    def read(self, text: TraceText, options: TraceOptions) -> TraceSamples:
        """Samples of the delay's column, timed if there is a column of times."""
        header = comments(text)
        start = next((i for i, line in enumerate(text.lines) if line.strip() and line[0] != "#"), None)
        if start is None:
            text.fail("no samples")
        columns = _Columns(text, start, header, options)
        samples = TraceSamples(
            kind_in(header, options, text) or "one-way", provenance=header.get("provenance", "")
        )
        period = period_in(header, options, text)
        if columns.time_at is None:
            samples.period = period
        else:
            samples.times = []
        for index in range(columns.first, len(text.lines)):
            if not text.lines[index].strip() or text.lines[index].startswith("#"):
                continue
            cells = columns.cells(index)
            samples.delays.append(columns.delay(cells, index + 1))
            if samples.times is not None:
                instant = columns.instant(cells, index + 1)
                if samples.times and instant < samples.times[-1]:
                    text.fail(f"the time goes backwards: {text.excerpt(index + 1)}", index + 1)
                samples.times.append(instant)
        return samples


class _Columns:
    """Where the delay and the time stand, and in which units.

    Args:
        text: the file.
        start: index of the first line that is no comment: the columns' names, or a row.
        header: the comments before.
        options: what the caller says.
    """

    def __init__(self, text: TraceText, start: int, header: dict[str, str], options: TraceOptions) -> None:
        self._text = text
        names = _cells(text, start)
        self._count = len(names)
        has_names = not all(_is_number(name) for name in names)
        self._delay_at = _delay_column(names if has_names else [], len(names), options, text)
        time_at = _time_column(names) if has_names else None
        self.time_at = None if time_at == self._delay_at else time_at
        unit = options.unit or header.get("unit") or (_unit_of(names[self._delay_at]) if has_names else None)
        if unit is None:
            text.fail(
                f"no unit: give one of {', '.join(UNITS)}, or a header line such as '# unit: ms'", start + 1
            )
        self._factor = factor_of(unit, text)
        self._time_factor = 1.0 if self.time_at is None else UNITS[_unit_of(names[self.time_at]) or "s"]
        self._least = 1 + max(self._delay_at, self.time_at or 0)
        self.first = start + (1 if has_names else 0)

    def cells(self, index: int) -> list[str]:
        """The cells of a row that has all that is needed."""
        cells = _cells(self._text, index)
        if len(cells) < self._least:
            self._text.fail(f"{len(cells)} columns where {self._count} are expected", index + 1)
        return cells

    def delay(self, cells: list[str], line: int) -> float:
        """The delay (s); NaN: lost."""
        word = cells[self._delay_at]
        if word.lower() in _LOST:
            return math.nan
        return check_delay(number(word, self._text, line, "a delay") * self._factor, self._text, line)

    def instant(self, cells: list[str], line: int) -> float:
        """The time (s); only with a column of times."""
        return number(cells[self.time_at or 0], self._text, line, "a time") * self._time_factor


def _cells(text: TraceText, index: int) -> list[str]:
    try:
        return [cell.strip() for cell in next(csv.reader(StringIO(text.lines[index])), [""])]
    except csv.Error as error:
        text.fail(f"unreadable: {error}", index + 1)


def _is_number(word: str) -> bool:
    if word.lower() in _LOST:
        return True
    try:
        float(word)
    except ValueError:
        return False
    return True


def _base(name: str) -> str:
    found = _UNIT_IN_NAME.match(name)
    return (found.group(1) if found else name).strip().lower()


def _unit_of(name: str) -> str | None:
    found = _UNIT_IN_NAME.match(name)
    unit = next((group for group in found.groups()[1:] if group), None) if found else None
    return unit if unit in UNITS else None


def _delay_column(names: list[str], count: int, options: TraceOptions, text: TraceText) -> int:
    wanted = options.column
    if wanted is not None:
        for index, name in enumerate(names):
            if wanted in (name, _base(name)):
                return index
        if wanted.isascii() and wanted.isdigit() and len(wanted) < 6 and 1 <= int(wanted) <= count:
            return int(wanted) - 1
        text.fail(f"no column {wanted!r}; there are {', '.join(names) if names else f'1 to {count}'}")
    for known in _DELAY_NAMES:
        for index, name in enumerate(names):
            if _base(name) == known:
                return index
    if count == 1:
        return 0
    text.fail(f"which column is the delay? Give one of {', '.join(names) if names else f'1 to {count}'}")


def _time_column(names: list[str]) -> int | None:
    return next((index for index, name in enumerate(names) if _base(name) in _TIME_NAMES), None)
