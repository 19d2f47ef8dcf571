"""A recording that a word names: its file and options, `FILE[,OPTION=VALUE...]`, and the open trace.

The options are those of `load_trace` and `Trace.replayed`: unit, column, period (ms), kind, format, gap, time_unit,
decimal, lost, sort (yes or no), at_end, share.
"""

import multiprocessing
import os
import sys
from functools import lru_cache
from typing import Any

from farhand.netem.recordings.formats.base import DECIMALS, KINDS, UNITS
from farhand.netem.recordings.gaps import GAPS
from farhand.netem.recordings.playback import AT_ENDS
from farhand.netem.recordings.trace import Trace, load_trace
from farhand.netem.words.reader import SpecReader, path_text

OPTIONS = (
    "unit", "column", "period", "kind", "format", "gap", "time_unit", "decimal", "lost", "sort", "at_end", "share"
)  # fmt: skip
_CHOICES = {
    "unit": tuple(UNITS),
    "time_unit": tuple(UNITS),
    "kind": KINDS,
    "gap": GAPS,
    "at_end": AT_ENDS,
    "decimal": DECIMALS,
    "sort": ("yes", "no"),
}
Options = tuple[tuple[str, str], ...]


def parse_options(reader: SpecReader) -> Options:
    """Read `,NAME=VALUE` pairs."""
    found: dict[str, str] = {}
    while reader.take(","):
        start = reader.position
        name = reader.name()
        if name not in OPTIONS or name in found:
            reader.fail(f"expected an option of the trace, once each: {', '.join(OPTIONS)}", start)
        reader.expect("=", f"the value of {name}")
        start = reader.position
        if name == "period":
            milliseconds = reader.number("the period in ms")
            if not 1e-3 <= milliseconds <= 1e9:
                reader.fail("the period in ms is out of range", start)
            found[name] = repr(milliseconds)
        elif name == "share":
            found[name] = repr(reader.probability("the uplink's share of a round trip", one_is_clear=True))
        else:
            found[name] = reader.path(f"the value of {name}")
            if name in _CHOICES and found[name] not in _CHOICES[name]:
                reader.fail(f"{name} is one of {', '.join(_CHOICES[name])}", start)
    return tuple(sorted(found.items()))


def options_text(options: Options) -> str:
    """`,NAME=VALUE` pairs."""
    return "".join(f",{name}={path_text(value)}" for name, value in options)


def open_trace(path: str, options: Options) -> Trace:
    """The trace; raises TraceError. Read once for all flows, and again when the file has changed."""
    try:
        state = os.stat(path)
        stamp = (state.st_mtime_ns, state.st_size)
    except (OSError, ValueError):
        stamp = (0, 0)
    return _open_trace(path, options, stamp)


def prepare_trace(path: str, options: Options) -> None:
    """Read the file, and say aloud, once, what of it was assumed or left out; raises TraceError."""
    notes = tuple(open_trace(path, options).reading.notes)
    if notes and multiprocessing.parent_process() is None:  # a worker's parent has said it
        _say_aloud(path, notes)


@lru_cache(maxsize=64)
def _say_aloud(path: str, notes: tuple[str, ...]) -> None:
    for note in notes:
        print(f"note: trace {path}: {note}", file=sys.stderr)


@lru_cache(maxsize=8)
def _open_trace(path: str, options: Options, stamp: tuple[int, int]) -> Trace:
    read: dict[str, Any] = dict(options)
    replay: dict[str, Any] = {}
    if "period" in read:
        read["period"] = float(read["period"]) / 1000
    if "sort" in read:
        read["sort"] = read["sort"] == "yes"
    if "share" in read:
        replay["uplink_share"] = float(read.pop("share"))
    if "at_end" in read:
        replay["at_end"] = read.pop("at_end")
    return load_trace(path, **read).replayed(**replay)
