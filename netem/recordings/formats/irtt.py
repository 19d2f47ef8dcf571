"""JSON of irtt (isochronous round-trip tester): `round_trips`, each with `lost` and `delay` in ns.

`column` chooses `rtt` (default), or the one-way `send` or `receive`, which need synchronised clocks.
"""

import itertools
import math
from typing import Any, ClassVar

import msgspec

from farhand.netem.recordings.formats.base import (
    UNITS,
    TraceFormat,
    TraceOptions,
    TraceSamples,
    TraceText,
    check_delay,
)

_COLUMNS = ("rtt", "send", "receive")


class _Wall(msgspec.Struct):
    monotonic: int = 0
    wall: int = 0


class _Client(msgspec.Struct):
    send: _Wall = msgspec.field(default_factory=_Wall)


class _Stamps(msgspec.Struct):
    client: _Client = msgspec.field(default_factory=_Client)


class _RoundTrip(msgspec.Struct):
    seqno: int = 0
    lost: str | bool = "false"
    delay: dict[str, Any] | None = None
    timestamps: _Stamps = msgspec.field(default_factory=_Stamps)


class _Report(msgspec.Struct):
    round_trips: list[_RoundTrip]


class Irtt(TraceFormat):
    """JSON of irtt."""

    name: ClassVar[str] = "irtt"

    def matches(self, text: TraceText) -> bool:
        """Whether this is JSON with round trips."""
        head = "\n".join(text.lines[:4])
        return head.lstrip().startswith("{") and any('"round_trips"' in line for line in text.lines)

    def read(self, text: TraceText, options: TraceOptions) -> TraceSamples:
        """Timed round trips, or delays one way."""
        column = options.column or "rtt"
        if column not in _COLUMNS:
            text.fail(f"no column {column!r}; there are {', '.join(_COLUMNS)}")
        if options.unit not in (None, "ns"):
            text.fail(f"unit {options.unit!r}: irtt writes ns")
        try:
            report = msgspec.json.decode("\n".join(text.lines), type=_Report)
        except (msgspec.DecodeError, RecursionError, ValueError) as error:
            text.fail(f"not the JSON of irtt: {error}")
        samples = TraceSamples(
            options.kind or ("round-trip" if column == "rtt" else "one-way"), provenance="irtt"
        )
        times: list[float] = []
        for index, trip in enumerate(report.round_trips):
            lost = trip.lost is True or (isinstance(trip.lost, str) and trip.lost.startswith("true"))
            delay = None if lost or trip.delay is None else trip.delay.get(column)
            if delay is None:
                samples.delays.append(math.nan)
            elif isinstance(delay, int) and not isinstance(delay, bool) and 0 <= delay < 1 << 62:
                samples.delays.append(check_delay(delay * UNITS["ns"], text, 1))
            else:
                text.fail(f"round_trips[{index}].delay.{column}: expected ns >= 0, got {str(delay)[:40]!r}")
            times.append(trip.timestamps.client.send.monotonic * UNITS["ns"])
        if all(b > a for a, b in itertools.pairwise(times)):
            samples.times = times
        else:
            samples.period = options.period
        return samples
