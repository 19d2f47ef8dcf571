"""`trace:FILE[,OPTION=VALUE...]` replays a recording in time; `empirical:FILE[,...]` draws from it at random.

tc-netem has only the latter, as a distribution table. The options are those of trace_file.py.
"""

from typing import ClassVar

import numpy as np

from farhand.netem.impairments.base import ImpairmentContext
from farhand.netem.impairments.delay import DelayWord
from farhand.netem.impairments.trace_file import (
    Options,
    open_trace,
    options_text,
    parse_options,
    prepare_trace,
)
from farhand.netem.recordings.playback import DelaySampler
from farhand.netem.words.reader import SpecReader, path_text


class DelayByTrace(DelayWord, frozen=True):
    """A recording, replayed by the time since the first message (or message by message if it has no times).

    Attributes:
        path: the file.
        options: for `load_trace`.
    """

    path: str
    options: Options = ()
    name: ClassVar[str] = "trace"
    example: ClassVar[str] = "trace:delays.csv"
    description: ClassVar[str] = "replays a recorded delay trace"

    @classmethod
    def parse(cls, reader: SpecReader) -> "DelayByTrace":
        """`:FILE[,OPTION=VALUE...]`."""
        reader.expect(":", "the file")
        return cls(reader.path("the trace's file"), parse_options(reader))

    def text(self) -> str:
        """Canonical word."""
        return f"{self.name}:{path_text(self.path)}{options_text(self.options)}"

    def prepare(self) -> None:
        """Read the file; raises TraceError."""
        prepare_trace(self.path, self.options)

    def sampler(self, context: ImpairmentContext) -> DelaySampler:
        """The replay; all flows of a direction are at the same place of a timed trace."""
        trace = open_trace(self.path, self.options)
        sampler = trace.sampler(context.direction)
        if trace.duration is not None:
            sampler.draw(context.origin_ns)
        return sampler


class Empirical(DelayByTrace, frozen=True):
    """Independent draws from a recording's delays, its losses left out."""

    name: ClassVar[str] = "empirical"
    example: ClassVar[str] = "empirical:delays.csv"
    description: ClassVar[str] = "draws from a recorded delay trace at random"

    def sampler(self, context: ImpairmentContext) -> DelaySampler:
        """Independent draws."""
        delays = open_trace(self.path, self.options).delays_of(context.direction)
        return _EmpiricalSampler(delays[~np.isnan(delays)].tolist(), context.rng("delay"))


class _EmpiricalSampler:
    def __init__(self, delays: list[float], rng: np.random.Generator) -> None:
        self._delays = delays
        self._random = rng.random

    def draw(self, now_ns: int) -> float:
        return self._delays[int(self._random() * len(self._delays))]
