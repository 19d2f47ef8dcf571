"""One delay a line, one line per slot of time: `# period: 10 ms` in the head, or `10ms` in the file's name.

Values are one-way milliseconds unless the header or the caller says otherwise; `lost` is a lost slot.
"""

import math
import re
from typing import ClassVar

from farhand.netem.recordings.formats.base import (
    TraceFormat,
    TraceOptions,
    TraceSamples,
    TraceText,
    check_delay,
    comments,
    factor_of,
    kind_in,
    number,
    period_in,
)

_PERIOD_IN_NAME = re.compile(r"(?<![0-9.])(\d{1,6})ms[^/]*\Z")
_LOST = {"lost", "nan"}


class Slots(TraceFormat):
    """One delay a line."""

    name: ClassVar[str] = "slots"
    general: ClassVar[bool] = True

    def matches(self, text: TraceText) -> bool:
        """Whether the first line that is no comment is a lone number."""
        first = next((line.strip() for line in text.lines if line.strip() and line[0] != "#"), "")
        try:
            float(first)
        except ValueError:
            return first in _LOST
        return True

    def read(self, text: TraceText, options: TraceOptions) -> TraceSamples:
        """Evenly spaced samples."""
        header = comments(text)
        if options.column not in (None, "1"):
            text.fail(f"no column {options.column!r}: there is one value a line")
        period = period_in(header, options, text)
        if period is None and (found := _PERIOD_IN_NAME.search(text.name)) is not None:
            period = int(found.group(1)) * 1e-3
        if not period:
            text.fail(
                "how long is a slot? Give the period, or a header line such as '# period: 10 ms' "
                "(a packet-delivery trace of mahimahi describes a rate, not delays)"
            )
        factor = factor_of(options.unit or header.get("unit") or "ms", text)
        samples = TraceSamples(
            kind_in(header, options, text) or "one-way",
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
