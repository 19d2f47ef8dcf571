"""JSON of irtt (isochronous round-trip tester): `round_trips`, each with `lost` and `delay` in ns.

`column` chooses `rtt` (default), or the one-way `send` or `receive`. These compare two clocks, of which the file does
not say whether they agree: `kind=one-way` says that they do, and delays below zero or above the round trip's prove that
they do not. `irtt client -o` packs its file (`.json.gz`), which is read as well.
Round trips are read one by one, whatever the size of the file; one that was cut off gives those that are whole.
"""

import itertools
import math
from typing import Any, ClassVar

import msgspec

from farhand.netem.recordings.formats.base import (
    MAX_SAMPLES,
    UNITS,
    TraceFormat,
    TraceOptions,
    TraceSamples,
    TraceText,
    check_delay,
)
from farhand.netem.recordings.formats.json_stream import CutOffError, JsonError, JsonStream

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


class _Config(msgspec.Struct):
    interval: int = 0


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
        if column != "rtt" and options.kind != "one-way":
            text.fail(
                f"column {column}: irtt does not know whether its two clocks agree; if they were synchronised, say "
                "kind=one-way (--kind one-way), else take the rtt"
            )
        kind = options.kind or "round-trip"
        samples = TraceSamples(kind, provenance="irtt", rows_missing="none")
        text.how("column", column)
        text.how("unit", "ns (as irtt writes)")
        text.how("kind", f"{options.kind} (as said)" if options.kind else "round-trip (as irtt measures)")
        times: list[float] = []
        interval = _read(text, column, samples.delays, times)
        if all(b > a for a, b in itertools.pairwise(times)):
            samples.times = times
            text.how("times", "ns of the client's clock")
            return samples
        samples.period = options.period or interval * UNITS["ns"] or None
        text.say("the sending times do not increase, and are not used; the interval is, if the file says it")
        return samples


def _read(text: TraceText, column: str, delays: list[float], times: list[float]) -> int:
    """Take the round trips one by one, so that no file is too large; returns the interval (ns; 0: not said)."""
    stream, interval, found = JsonStream(text.lines), 0, False
    try:
        for key in stream.members():
            if key == "round_trips":
                found = True
                _take_trips(stream, text, column, delays, times)
            elif key == "config":
                interval = msgspec.convert(stream.value(), _Config).interval
            else:
                stream.value()
    except CutOffError:
        if not delays:
            text.fail("not the JSON of irtt: it is cut off before the first whole round trip")
        text.say(f"the file is cut off within or after round_trips[{len(delays)}]: read up to there")
    except (JsonError, msgspec.ValidationError, ValueError) as error:
        text.fail(f"not the JSON of irtt: {error}")
    if not found:
        text.fail("not the JSON of irtt: it has no round_trips")
    return interval


def _take_trips(
    stream: JsonStream, text: TraceText, column: str, delays: list[float], times: list[float]
) -> None:
    for index, item in enumerate(stream.items()):
        if index >= MAX_SAMPLES:
            text.fail(f"more than {MAX_SAMPLES} samples; at most as many can be read")
        try:
            trip = msgspec.convert(item, _RoundTrip)
        except msgspec.ValidationError as error:
            text.fail(f"not the JSON of irtt: round_trips[{index}]: {error}")
        delays.append(_delay(trip, column, f"round_trips[{index}].delay", text))
        times.append(trip.timestamps.client.send.monotonic * UNITS["ns"])


def _delay(trip: _RoundTrip, column: str, where: str, text: TraceText) -> float:
    """A delay (s); NaN: lost."""
    lost = trip.lost is True or (isinstance(trip.lost, str) and trip.lost.startswith("true"))
    delay = None if lost or trip.delay is None else trip.delay.get(column)
    if delay is None or trip.delay is None:
        return math.nan
    if isinstance(delay, bool) or not isinstance(delay, int) or abs(delay) >= 1 << 62:
        text.fail(f"{where}.{column}: expected ns >= 0, got {str(delay)[:40]!r}")
    whole = trip.delay.get("rtt")
    if column != "rtt" and (delay < 0 or (isinstance(whole, int) and delay > whole)):
        text.fail(
            f"{where}.{column}: {delay} ns of a round trip of {whole}: the two clocks do not agree; take the rtt"
        )
    if delay < 0:
        text.fail(f"{where}.{column}: expected ns >= 0, got {delay}")
    return check_delay(delay * UNITS["ns"], text, 1)
