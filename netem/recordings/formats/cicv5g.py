"""The text of the CICV5G data set: blank-separated columns under a header, round trips of a vehicle over 5G.

    pub_time(ms) sub_time(ms) delay(ms) utmX(m) ...
    1721032372703 1721032372729 26 328977.510000 ...

Lost echoes are not rows: the gaps in `pub_time` tell of them.
"""

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
        samples = TraceSamples(options.kind or "round-trip", times=[], provenance="CICV5G")
        times: list[float] = []
        for index, content in enumerate(text.lines[1:], start=2):
            cells = content.split()
            if not cells:
                continue
            if len(cells) <= max(time_at, delay_at):
                text.fail(f"{len(cells)} columns where {len(names)} are expected", index)
            delay = number(cells[delay_at], text, index, "a delay") * factor
            samples.delays.append(check_delay(delay, text, index))
            instant = number(cells[time_at], text, index, "a time in ms") * 1e-3
            if times and instant < times[-1]:
                text.fail(f"the time goes backwards: {text.excerpt(index)}", index)
            times.append(instant)
        samples.times = times
        return samples
