"""`trace:FILE[,OPTION=VALUE...]` replays a recording in time; `empirical:FILE[,...]` draws from it at random.

tc-netem has only the latter, as a distribution table. The options are those of `load_trace`: unit, column,
period (ms), kind, format, gap, at_end, share.
"""

import os
from functools import lru_cache
from typing import Any, ClassVar

import numpy as np

from farhand.netem.impairments.base import Context
from farhand.netem.impairments.delay import DelayWord, Sampler
from farhand.netem.recordings.trace import Trace, load_trace
from farhand.netem.words.reader import Reader, path_text

OPTIONS = ("unit", "column", "period", "kind", "format", "gap", "at_end", "share")
Options = tuple[tuple[str, str], ...]


def parse_options(reader: Reader) -> Options:
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
            found[name] = repr(reader.probability("the uplink's share of a round trip"))
        else:
            found[name] = reader.path(f"the value of {name}")
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


@lru_cache(maxsize=8)
def _open_trace(path: str, options: Options, stamp: tuple[int, int]) -> Trace:
    values: dict[str, Any] = dict(options)
    if "period" in values:
        values["period"] = float(values["period"]) / 1000
    if "share" in values:
        values["uplink_share"] = float(values.pop("share"))
    return load_trace(path, **values)


class Replay(DelayWord, frozen=True):
    """A recording, replayed by the time since the first message (or message by message if it has no times).

    Attributes:
        path: the file.
        options: for `load_trace`.
    """

    path: str
    options: Options = ()
    word: ClassVar[str] = "trace"

    @classmethod
    def parse(cls, reader: Reader) -> "Replay":
        """`:FILE[,OPTION=VALUE...]`."""
        reader.example = f"{cls.word}:delays.csv"
        reader.expect(":", "the file")
        return cls(reader.path("the trace's file"), parse_options(reader))

    def text(self) -> str:
        """Canonical word."""
        return f"{self.word}:{path_text(self.path)}{options_text(self.options)}"

    def prepare(self) -> None:
        """Read the file; raises TraceError."""
        open_trace(self.path, self.options)

    def sampler(self, context: Context) -> Sampler:
        """The replay; all flows of a direction are at the same place of a timed trace."""
        trace = open_trace(self.path, self.options)
        sampler = trace.sampler(context.direction, context.rng("delay"))
        if trace.duration is not None:
            sampler.draw(context.origin_ns)
        return sampler


class Empirical(Replay, frozen=True):
    """Independent draws from a recording's delays, its losses left out."""

    word: ClassVar[str] = "empirical"

    def sampler(self, context: Context) -> Sampler:
        """Independent draws."""
        delays = open_trace(self.path, self.options).delays_of(context.direction)
        return _EmpiricalSampler(delays[~np.isnan(delays)].tolist(), context.rng("delay"))


class _EmpiricalSampler:
    def __init__(self, delays: list[float], rng: np.random.Generator) -> None:
        self._delays = delays
        self._random = rng.random

    def draw(self, now_ns: int) -> float:
        return self._delays[int(self._random() * len(self._delays))]
