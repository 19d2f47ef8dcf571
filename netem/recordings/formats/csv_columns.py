"""Which column of a CSV file is the delay and which the time, in which units, and what lies between the cells."""

import csv
import re
from dataclasses import dataclass

from farhand.netem.recordings.formats.base import UNITS, Kind, TraceOptions, TraceText, factor_of

LOST = {
    "", "lost", "nan", "none", "null", "nil", "inf", "na", "n/a", "#n/a", "-", "--", "*", "timeout", "timed out",
    "missing",
}  # fmt: skip
ROUND_TRIP_NAMES = ("rtt", "round_trip", "roundtrip", "round_trip_time", "ping")
ONE_WAY_NAMES = ("owd", "one_way", "one_way_delay", "oneway")
DELAY_NAMES = ("delay", *ROUND_TRIP_NAMES, "latency", *ONE_WAY_NAMES)
TIME_NAMES = (
    "time",
    "t",
    "timestamp",
    "time_stamp",
    "ts",
    "datetime",
    "epoch",
    "sent",
    "send_time",
    "unix_time",
)
_SEPARATORS = "\t;,"
_UNIT_NAMES = {
    "sec": "s", "secs": "s", "seconds": "s", "msec": "ms", "millis": "ms", "milliseconds": "ms", "usec": "us",
    "micros": "us", "microseconds": "us", "nsec": "ns", "nanos": "ns", "nanoseconds": "ns",
}  # fmt: skip
_UNIT_IN_NAME = re.compile(
    rf"(.+?)\s*(?:\((\w+)\)|\[(\w+)\]|[_ .-]({'|'.join([*sorted(UNITS), *_UNIT_NAMES])}))\Z", re.IGNORECASE
)


@dataclass(frozen=True)
class Layout:
    """Where things are.

    Attributes:
        separator: between cells.
        count: of cells in a row.
        first: index of the first row.
        delay_at, time_at: of the cells; no time: None.
        factor: of the delay's unit (s).
        time_unit: that the time's name says, if it does.
        kind: that the delay's name says, if it does.
    """

    separator: str
    count: int
    first: int
    delay_at: int
    time_at: int | None
    factor: float
    time_unit: str | None
    kind: Kind | None


def layout_of(text: TraceText, start: int, header: dict[str, str], options: TraceOptions) -> Layout:
    """The layout by the line `start` (an index), which names the columns or is a row; raises TraceError."""
    separator = _separator(text.lines[start], options)
    names = cells(text, start, separator)
    has_names = not all(is_number(name) for name in names)
    found = names if has_names else []
    if has_names and not _has_numbers(text, start + 1, separator, len(names)):
        text.fail("no recording of delays: no row below its first line has a number in it")
    delay_at = _delay_column(found, len(names), options, text)
    time_at = next((i for i, name in enumerate(found) if base(name) in TIME_NAMES and i != delay_at), None)
    delay_name = names[delay_at] if has_names else ""
    factor = _factor(delay_name, header, options, text, start)
    text.how("column", repr(delay_name) if has_names else f"{delay_at + 1} (no names)")
    if separator != ",":
        text.how("cells parted by", "a tab" if separator == "\t" else repr(separator))
    kind: Kind | None = None
    if base(delay_name) in ROUND_TRIP_NAMES:
        kind = "round-trip"
    elif base(delay_name) in ONE_WAY_NAMES:
        kind = "one-way"
    time_unit = None if time_at is None else _unit_of(names[time_at])
    return Layout(separator, len(names), start + has_names, delay_at, time_at, factor, time_unit, kind)


def cells(text: TraceText, index: int, separator: str) -> list[str]:
    """The cells of a line; raises TraceError where quotation marks do not match."""
    line = text.lines[index]
    if '"' not in line:
        return [cell.strip() for cell in line.split(separator)]
    try:
        return [cell.strip() for cell in next(csv.reader([line], delimiter=separator), [""])]
    except csv.Error as error:
        text.fail(f"unreadable: {error}", index + 1)


def is_number(word: str) -> bool:
    """Whether a cell is a number, however its fraction is written, or a lost message."""
    if word.lower() in LOST:
        return True
    try:
        float(word.replace(",", ""))
    except ValueError:
        return False
    return True


def _has_numbers(text: TraceText, first: int, separator: str, count: int) -> bool:
    """Whether any later row with as many cells has a number, or a word for a lost message, in one of them."""
    for index in range(first, len(text.lines)):
        row = [cell.strip(' "') for cell in text.lines[index].split(separator)]
        if len(row) >= count and any(cell and is_number(cell) for cell in row):
            return True
    return False


def base(name: str) -> str:
    """A column's name without its unit, in lower case."""
    found = _UNIT_IN_NAME.match(name)
    return (found.group(1) if found else name).strip().lower().replace(" ", "_").replace("-", "_")


def _separator(line: str, options: TraceOptions) -> str:
    found = next((separator for separator in _SEPARATORS if separator in line), None)
    if found == "," and options.decimal == "comma" and is_number(line.strip()):
        # A column of numbers with commas is one column, if its commas are said to be decimal.
        return ";"
    return found or (";" if options.decimal == "comma" else ",")


def _unit_of(name: str) -> str | None:
    found = _UNIT_IN_NAME.match(name)
    unit = next((group for group in found.groups()[1:] if group), "").lower() if found else ""
    unit = _UNIT_NAMES.get(unit, unit)
    return unit if unit in UNITS else None


def _factor(name: str, header: dict[str, str], options: TraceOptions, text: TraceText, start: int) -> float:
    named, headed = _unit_of(name), header.get("unit")
    if options.unit is not None:
        text.how("unit", f"{options.unit} (as said)")
        return factor_of(options.unit, text)
    if headed is not None:
        if named is not None and UNITS.get(headed) != UNITS[named]:
            text.fail(
                f"the header says unit {headed}, the column {name!r} another; say unit={named} (--unit)"
            )
        text.how("unit", f"{headed} (the header)")
        return factor_of(headed, text)
    if named is None:
        text.fail(
            f"no unit: give one of {', '.join(UNITS)}, or a header line such as '# unit: ms'", start + 1
        )
    text.how("unit", f"{named} (the column's name)")
    return UNITS[named]


def _delay_column(names: list[str], count: int, options: TraceOptions, text: TraceText) -> int:
    wanted, there = options.column, ", ".join(names) if names else f"1 to {count}"
    if wanted is not None:
        for index, name in enumerate(names):
            if wanted in (name, base(name)):
                return index
        if wanted.isascii() and wanted.isdigit() and len(wanted) < 6 and 1 <= int(wanted) <= count:
            return int(wanted) - 1
        text.fail(f"no column {wanted!r}; there are {there}")
    known = [index for index, name in enumerate(names) if base(name) in DELAY_NAMES]
    if len(known) == 1:
        return known[0]
    if count == 1:
        return 0
    if known:
        there = ", ".join(names[index] for index in known)
    hint = (
        "" if names else "; or is it one column with decimal commas? Then say decimal=comma (--decimal comma)"
    )
    text.fail(f"which column is the delay? Give one of {there}{hint}")
