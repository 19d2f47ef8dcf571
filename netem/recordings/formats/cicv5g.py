"""The text of the CICV5G data set: blank-separated columns under a header, round trips of a vehicle over 5G.

    pub_time(ms) sub_time(ms) delay(ms) utmX(m) ...
    1721032372703 1721032372729 26 328977.510000 ...

Lost echoes are not rows: the gaps in `pub_time` tell of them.
"""

from itertools import islice
from typing import ClassVar

from farhand.netem.recordings.formats.base import (
    TraceFormat,
    TraceOptions,
    TraceSamples,
    TraceText,
    check_delay,
    factor_of,
    number,
)

_TIME = "pub_time(ms)"
_DELAY = "delay(ms)"


class Cicv5g(TraceFormat):
    """The text of the CICV5G data set."""

    name: ClassVar[str] = "cicv5g"

    def matches(self, text: TraceText) -> bool:
        """Whether the first line is the data set's header."""
        return text.lines[0].split()[:1] == [_TIME]

    def read(self, text: TraceText, options: TraceOptions) -> TraceSamples:
        """Timed round trips."""
        names = text.lines[0].split()
        column = options.column or _DELAY
        if _TIME not in names:
            text.fail(f"the header has no column {_TIME}", 1)
        if column not in names:
            text.fail(f"no column {column!r}; there are {', '.join(names)}", 1)
        factor = factor_of(options.unit or "ms", text)
        time_at, delay_at = names.index(_TIME), names.index(column)
        samples = TraceSamples(
            options.kind or "round-trip", times=[], provenance="CICV5G", rows_missing="lost"
        )
        text.how("column", repr(column))
        text.how("unit", f"{options.unit or 'ms'} (the data set's)")
        text.how("times", "ms since 1970 (the data set's)")
        text.say("lost echoes have no row in this data set: gaps in its times are losses")
        times: list[float] = []
        lines: list[int] = []
        for index, content in enumerate(islice(text.lines, 1, None), start=2):
            cells = content.split()
            if not cells:
                continue
            if text.cut_off_at(index) and len(cells) <= delay_at + 1 < len(names):
                text.say_cut_off(index)
                break
            if len(cells) <= max(time_at, delay_at):
                text.fail(f"{len(cells)} columns where {len(names)} are expected", index)
            delay = number(cells[delay_at], text, index, "a delay") * factor
            samples.delays.append(check_delay(delay, text, index))
            lines.append(index)
            times.append(number(cells[time_at], text, index, "a time in ms") * 1e-3)
        samples.times, samples.lines = times, lines
        return samples
