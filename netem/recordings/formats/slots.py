"""One delay a line, one line per slot of time: `# period: 10 ms` in the head, or `10ms_slots` in the file's name.

Values are one-way milliseconds unless the header or the caller says otherwise; `lost` is a lost slot.
"""

import math
import re
from typing import ClassVar

from farhand.netem.recordings.formats.base import (
    ZERO_ASKED,
    TraceFormat,
    TraceOptions,
    TraceSamples,
    TraceText,
    check_delay,
    comments,
    factor_of,
    is_lost,
    kind_in,
    number,
    period_in,
)
from farhand.netem.recordings.formats.csv_columns import LOST

_PERIOD_IN_NAME = re.compile(r"(?<![0-9.])(\d{1,6})ms[_-]?slots?[^/]*\Z", re.IGNORECASE)
_LOST = LOST - {"", "inf"}


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
            return first.lower() in _LOST
        return True

    def read(self, text: TraceText, options: TraceOptions) -> TraceSamples:
        """Evenly spaced samples."""
        header = comments(text)
        if options.column not in (None, "1"):
            text.fail(f"no column {options.column!r}: there is one value a line")
        period = period_in(header, options, text)
        if period is None and (found := _PERIOD_IN_NAME.search(text.name)) is not None:
            period = int(found.group(1)) * 1e-3
            text.say(f"slots of {found.group(1)} ms, as the file's name says: else period=MS (--period)")
        if not period:
            text.fail(
                "how long is a slot? Give the period, or a header line such as '# period: 10 ms' "
                "(a packet-delivery trace of mahimahi describes a rate, not delays)"
            )
        unit = options.unit or header.get("unit")
        text.how("unit", f"{unit} (as said)" if unit else "ms (assumed)")
        if not unit:
            text.say("the file does not say the unit of its delays; ms is assumed: else unit=us (--unit us)")
        factor = factor_of(unit or "ms", text)
        text.how("slot", f"{period * 1e3:g} ms")
        samples = TraceSamples(
            kind_in(header, options, text),
            period=period,
            provenance=header.get("provenance", ""),
        )
        for line, content in enumerate(text.lines, start=1):
            word = content.strip()
            if not word or word.startswith("#"):
                continue
            if text.cut_off_at(line):
                text.say_cut_off(line)
            elif word.lower() in _LOST or is_lost(word, options.lost):
                samples.delays.append(math.nan)
            else:
                delay = check_delay(number(word, text, line, "one delay") * factor, text, line)
                if delay == 0 and options.lost is None:
                    text.fail(ZERO_ASKED, line)
                samples.delays.append(delay)
        return samples
