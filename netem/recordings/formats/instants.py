"""Times in a file: numbers in a unit, stamps since the epoch in whatever unit, and ISO 8601."""

import calendar
import re
from itertools import pairwise

from farhand.netem.recordings.formats.base import UNITS, TraceText, number

_ISO = re.compile(
    r"(\d{4})-(\d\d)-(\d\d)[T ](\d\d):(\d\d):(\d\d)(?:[.,](\d{1,12}))?\s*(?:(Z|UTC)|([+-])(\d\d):?(\d\d))?\Z"
)
_EPOCH = (1.0e9, 4.2e9)
"""Stamps of the years 2001 to 2103, in s since 1970."""
ASKED_FROM = 5.0
"""Whole numbers that lie so far apart (s, if they are s) are rather another unit, so the unit is asked for."""


def iso_instant(word: str) -> float | None:
    """Seconds since 1970 of an ISO 8601 date and time (UTC where it says no zone); None if it is none."""
    found = _ISO.match(word)
    if found is None:
        return None
    year, month, day, hour, minute, second = (int(part) for part in found.groups()[:6])
    if not (1 <= month <= 12 and 1 <= day <= 31 and hour < 24 and minute < 60 and second <= 60):
        return None
    offset = 0
    if found.group(9):
        offset = (int(found.group(10)) * 60 + int(found.group(11))) * (-60 if found.group(9) == "-" else 60)
    whole = calendar.timegm((year, month, day, hour, minute, second)) - offset
    return whole + (float(f"0.{found.group(7)}") if found.group(7) else 0.0)


def time_unit(values: list[float], stated: str | None, source: str, text: TraceText) -> float:
    """One unit of these times in s: the one that is stated, or that stamps since the epoch tell by their size.

    Raises:
        TraceError: stamps that cannot be in the stated unit, or times whose unit is not clear.
    """
    first = abs(values[0]) if values else 0.0
    fits = [unit for unit in ("s", "ms", "us", "ns") if _EPOCH[0] <= first * UNITS[unit] < _EPOCH[1]]
    if stated is not None:
        if fits and first * UNITS[stated] >= _EPOCH[1]:
            text.fail(
                f"times of {first:.6g} are {fits[0]} since 1970, not {stated} ({source}); say time_unit={fits[0]}"
            )
        text.how("times", f"{stated} ({source})")
        return UNITS[stated]
    if fits:
        text.how("times", f"{fits[0]} since 1970 (by their size)")
        return UNITS[fits[0]]
    apart = sorted(b - a for a, b in pairwise(values))
    if apart and apart[len(apart) // 2] >= ASKED_FROM and all(value == int(value) for value in values[:1000]):
        text.fail(
            f"times {apart[len(apart) // 2]:g} apart, in which unit? "
            "Say time_unit=ms (--time-unit ms), or s, us, ns"
        )
    text.how("times", "s (assumed)")
    text.say("the file does not say the unit of its times; s is assumed: else time_unit=ms (--time-unit)")
    return 1.0


def instant_of(word: str, text: TraceText, line: int) -> float:
    """A time as it stands: of an ISO date in s, else the number; raises TraceError."""
    found = iso_instant(word)
    return number(word, text, line, "a time") if found is None else found
