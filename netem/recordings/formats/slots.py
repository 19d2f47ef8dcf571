"""One delay a line, one line per slot of time: `# period: 10 ms` in the head, or `10ms` in the file's name.

Values are one-way milliseconds unless the header or the caller says otherwise; `lost` is a lost slot.
"""

import math
import re

from farhand.netem.recordings.formats.base import (
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

_PERIOD_IN_NAME = re.compile(r"(?<![0-9.])(\d{1,6})ms[^/]*\Z")
_LOST = {"lost", "nan"}


def matches(text: TraceText) -> bool:
    """Whether the first line that is no comment is a lone number."""
    first = next((line.strip() for line in text.lines if line.strip() and line[0] != "#"), "")
    try:
        float(first)
    except ValueError:
        return first in _LOST
    return True


def read(text: TraceText, options: ReadOptions) -> Samples:
    """Evenly spaced samples."""
    header = comments(text)
    if options.column not in (None, "1"):
        text.fail(f"no column {options.column!r}: there is one value a line")
    period = options.period
    if period is None and "period" in header:
        period = duration_in(header["period"], text, "period")
    if period is None and (found := _PERIOD_IN_NAME.search(text.name)) is not None:
        period = int(found.group(1)) * 1e-3
    if not period:
        text.fail(
            "how long is a slot? Give the period, or a header line such as '# period: 10 ms' "
            "(a packet-delivery trace of mahimahi describes a rate, not delays)"
        )
    factor = factor_of(options.unit or header.get("unit") or "ms", text)
    samples = Samples(
        options.kind or kind_in(header, text) or "one-way",
        period=period,
        provenance=header.get("provenance", ""),
    )
    for line, content in enumerate(text.lines, start=1):
        word = content.strip()
        if not word or word.startswith("#"):
            continue
        if word.lower() in _LOST:
            samples.delays.append(math.nan)
        else:
            samples.delays.append(check_delay(number(word, text, line, "one delay") * factor, text, line))
    return samples
