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

from farhand.netem.recordings.formats.base import (
    UNITS,
    Kind,
    ReadOptions,
    Samples,
    TraceText,
    check_delay,
    comments,
    duration_in,
    factor_of,
    kind_in,
    number,
)

MARK = "# farhand trace"
_DELAY_NAMES = ("delay", "rtt", "latency")
_TIME_NAMES = ("time", "t", "timestamp")
_LOST = {"", "lost", "nan", "none", "null", "inf"}
_UNIT_IN_NAME = re.compile(r"(.+?)\s*(?:\((\w+)\)|\[(\w+)\]|_(s|ms|us|ns))\Z")


def matches(text: TraceText) -> bool:
    """Whether this looks like comma-separated values."""
    if text.lines[0].lower().startswith(MARK):
        return True
    first = next((line for line in text.lines if line.strip() and not line.startswith("#")), "")
    return "," in first or first.strip().lower().startswith(_DELAY_NAMES)


def read(text: TraceText, options: ReadOptions) -> Samples:
    """Samples of the delay's column, timed if there is a column of times."""
    header = comments(text)
    start = next((i for i, line in enumerate(text.lines) if line.strip() and line[0] != "#"), None)
    if start is None:
        text.fail("no samples")
    names = _cells(text, start)
    has_names = not all(_is_number(name) for name in names)
    delay_at = _delay_column(names if has_names else [], len(names), options, text)
    time_at = _time_column(names) if has_names else None
    if time_at == delay_at:
        time_at = None
    unit = options.unit or header.get("unit") or (_unit_of(names[delay_at]) if has_names else None)
    if unit is None:
        text.fail(
            f"no unit: give one of {', '.join(UNITS)}, or a header line such as '# unit: ms'", start + 1
        )
    factor = factor_of(unit, text)
    time_factor = UNITS[(_unit_of(names[time_at]) or "s")] if time_at is not None else 1.0
    kind: Kind = options.kind or kind_in(header, text) or "one-way"
    period = options.period
    if period is None and "period" in header:
        period = duration_in(header["period"], text, "period")
    samples = Samples(
        kind, times=[] if time_at is not None else None, provenance=header.get("provenance", "")
    )
    if time_at is None:
        samples.period = period
    for index in range(start + (1 if has_names else 0), len(text.lines)):
        if not text.lines[index].strip() or text.lines[index].startswith("#"):
            continue
        cells, line = _cells(text, index), index + 1
        if delay_at >= len(cells) or (time_at is not None and time_at >= len(cells)):
            text.fail(f"{len(cells)} columns where {len(names)} are expected", line)
        word = cells[delay_at]
        if word.lower() in _LOST:
            samples.delays.append(math.nan)
        else:
            samples.delays.append(check_delay(number(word, text, line, "a delay") * factor, text, line))
        if time_at is not None and samples.times is not None:
            instant = number(cells[time_at], text, line, "a time") * time_factor
            if samples.times and instant < samples.times[-1]:
                text.fail(f"the time goes backwards: {text.excerpt(line)}", line)
            samples.times.append(instant)
    return samples


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


def _delay_column(names: list[str], count: int, options: ReadOptions, text: TraceText) -> int:
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
