"""Values separated by commas, semicolons or tabs, our own format first of all.

    # farhand trace
    # unit: ms
    # kind: round-trip
    # provenance: robot lab to server room, 50 messages a second of 300 bytes
    time,delay
    0.000,15.2
    0.020,lost

A time is in the unit that its column's name says (`time(ms)`, `time_ms`), a stamp since the epoch in the one that its
size tells, an ISO date is one; `delay` is in the header's unit. A delay that is empty, `lost`, `nan`, `NA`, `N/A` or
`-` is a lost message. Other CSV files are read with a `column` and a `unit` (the column's name may hold it: `rtt(ms)`,
`rtt_ms`). A column `rtt` holds round trips.
"""

import math
from typing import ClassVar

from farhand.netem.recordings.formats.base import (
    ZERO_ASKED,
    TraceFormat,
    TraceOptions,
    TraceSamples,
    TraceText,
    check_delay,
    comments,
    is_lost,
    kind_in,
    number,
    period_in,
)
from farhand.netem.recordings.formats.csv_columns import DELAY_NAMES, LOST, Layout, cells, layout_of
from farhand.netem.recordings.formats.decimals import decimal_of, plain
from farhand.netem.recordings.formats.instants import instant_of, iso_instant, time_unit

MARK = "# farhand trace"
Rows = tuple[list[int], list[str], list[str]]
"""Of each row: its line, the delay and the time as they stand."""


class CsvText(TraceFormat):
    """Comma-separated values."""

    name: ClassVar[str] = "csv"
    general: ClassVar[bool] = True

    def matches(self, text: TraceText) -> bool:
        """Whether this looks like separated values."""
        if text.lines[0].lower().startswith(MARK):
            return True
        first = next((line for line in text.lines if line.strip() and not line.startswith("#")), "")
        return any(mark in first.strip() for mark in ",;\t") or first.strip().lower().startswith(DELAY_NAMES)

    def read(self, text: TraceText, options: TraceOptions) -> TraceSamples:
        """Samples of the delay's column, timed if there is a column of times."""
        header = comments(text)
        start = next((i for i, line in enumerate(text.lines) if line.strip() and line[0] != "#"), None)
        if start is None:
            text.fail("no samples")
        layout = layout_of(text, start, header, options)
        is_ours = text.lines[0].lower().startswith(MARK)
        samples = TraceSamples(
            kind_in(header, options, text, layout.kind),
            provenance=header.get("provenance", ""),
            rows_missing="none" if is_ours else "unknown",
        )
        lines, delays, times = _rows(text, layout)
        samples.delays = _delays(lines, delays, layout, options, text, zero_is_clear=is_ours)
        samples.lines = lines
        if layout.time_at is None:
            samples.period = period_in(header, options, text)
        else:
            samples.times = _instants(lines, times, layout, options, text)
        return samples


def _rows(text: TraceText, layout: Layout) -> Rows:
    lines, delays, times = [], [], []
    time_at = layout.delay_at if layout.time_at is None else layout.time_at
    least = 1 + max(layout.delay_at, time_at)
    for index in range(layout.first, len(text.lines)):
        content = text.lines[index]
        if not content.strip() or content.startswith("#"):
            continue
        found = cells(text, index, layout.separator)
        if text.cut_off_at(index + 1) and len(found) <= least:
            text.say_cut_off(index + 1)
            break
        if len(found) < least:
            text.fail(f"{len(found)} columns where {layout.count} are expected", index + 1)
        if any(found[layout.count :]):
            text.fail(
                f"{len(found)} cells where {layout.count} are expected: {text.excerpt(index + 1)}; decimal commas need "
                "another mark between the cells (;), or quotation marks, or --decimal comma if there is one column",
                index + 1,
            )
        lines.append(index + 1)
        delays.append(found[layout.delay_at])
        times.append(found[time_at])
    return lines, delays, times


def _delays(
    lines: list[int],
    words: list[str],
    layout: Layout,
    options: TraceOptions,
    text: TraceText,
    *,
    zero_is_clear: bool,
) -> list[float]:
    decimal = decimal_of(words, options.decimal, "delay", text)
    found: list[float] = []
    for line, raw in zip(lines, words, strict=True):
        word = plain(raw, decimal)
        if word.lower() in LOST or is_lost(word, options.lost):
            found.append(math.nan)
            continue
        delay = check_delay(number(word, text, line, "a delay") * layout.factor, text, line)
        if delay == 0 and options.lost is None and not zero_is_clear:
            text.fail(ZERO_ASKED, line)
        found.append(delay)
    return found


def _instants(
    lines: list[int], words: list[str], layout: Layout, options: TraceOptions, text: TraceText
) -> list[float]:
    if words and iso_instant(words[0]) is not None:
        text.how("times", "ISO 8601")
        dates = [instant_of(word, text, line) for line, word in zip(lines, words, strict=True)]
        return [instant - dates[0] for instant in dates]
    decimal = decimal_of(words, options.decimal, "time", text)
    found = [
        number(plain(word, decimal), text, line, "a time") for line, word in zip(lines, words, strict=True)
    ]
    stated, source = (
        (options.time_unit, "as said") if options.time_unit else (layout.time_unit, "the column's name")
    )
    if stated is None and text.lines[0].lower().startswith(MARK):
        stated, source = "s", "farhand's format"
    factor = time_unit(found, stated, source, text)
    # From the first on, before the unit: a stamp in ns since the epoch has more digits than a float.
    return [(instant - found[0]) * factor for instant in found]
