"""Recorded delays: read, summarise, replay.

A trace of round trips is split into directions by a share: `uplink_share` of each delay goes to the
uplink, the rest to the downlink. A lost round trip is a time at which the path was down, in both
directions: nobody can tell which way the message was lost.
"""

import math
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from farhand.common.errors import TraceError
from farhand.common.timing.clock import to_ns
from farhand.netem.recordings.formats.base import (
    DECIMALS,
    KINDS,
    MAX_SAMPLES,
    UNITS,
    Decimal,
    Kind,
    Reading,
    TraceOptions,
    TraceSamples,
    TraceText,
)
from farhand.netem.recordings.formats.registry import format_called, format_of
from farhand.netem.recordings.gaps import GAPS, Gap, without_gaps
from farhand.netem.recordings.playback import AT_ENDS, AtEnd, DelaySampler, TimedReplay, UntimedReplay
from farhand.netem.recordings.text_file import read_text


@dataclass(frozen=True, eq=False)
class Trace:
    """Recorded delays.

    Attributes:
        recorded: delays as recorded (n,) (s); NaN = lost.
        times: instants of sending since the first (n,) (s), or None.
        period: spacing of evenly spaced samples (s), or None.
        kind: whether `recorded` holds one-way delays or round trips.
        provenance: where the recording comes from, as far as the file says.
        gap: what a lost message means in a replay: "loss"; "delay" holds messages until the next that
            arrived and so lets them come in one burst, as TCP does; "ignore" is "loss" for samples marked
            as lost, and takes missing rows for no news: the last sample stays in force.
        at_end: "wrap" (again from the start), "stop" (every later message is lost) or "hold" (last sample).
        uplink_share: part of a round trip that the uplink carries.
        reading: how the file was read.
    """

    recorded: NDArray[np.float64]
    times: NDArray[np.float64] | None
    period: float | None
    kind: Kind
    provenance: str
    gap: Gap = "loss"
    at_end: AtEnd = "wrap"
    uplink_share: float = 0.5
    reading: Reading = field(default_factory=Reading)

    @property
    def delays(self) -> NDArray[np.float64]:
        """Delays of the uplink (n,) (s); NaN = lost."""
        return self.delays_of("uplink")

    def delays_of(self, direction: str) -> NDArray[np.float64]:
        """Delays of one direction (n,) (s); NaN = lost. Direction: "uplink" or "downlink"."""
        if self.kind == "one-way":
            return self.recorded
        return self.recorded * (self.uplink_share if direction == "uplink" else 1.0 - self.uplink_share)

    @property
    def duration(self) -> float | None:
        """Time until the last sample is over (s); None if the samples have no times."""
        if self.times is not None:
            return float(self.times[-1]) + self._interval()
        return None if self.period is None else self.period * len(self.recorded)

    def _interval(self) -> float:
        """Median interval between samples (s); 1 s for a single one, whose own length nobody knows."""
        if self.times is None or len(self.times) < 2:
            return self.period or 1.0
        return max(float(np.median(np.diff(self.times))), 1e-6)

    def sampler(self, direction: str) -> DelaySampler:
        """A replay for one direction ("uplink" or "downlink"); nothing is drawn."""
        delays = self.delays_of(direction).tolist()
        if self.duration is None:
            return UntimedReplay(delays, self.at_end)
        if self.times is not None:
            starts = [to_ns(instant) for instant in self.times.tolist()]
        else:
            starts = [to_ns(index * (self.period or 0.0)) for index in range(len(delays))]
        return TimedReplay(
            starts, delays, max(to_ns(self.duration), starts[-1] + 1), self.at_end, self.gap == "delay"
        )

    def replayed(self, at_end: AtEnd = "wrap", uplink_share: float = 0.5) -> "Trace":
        """The same recording, to be replayed in another way; raises TraceError."""
        if at_end not in AT_ENDS:
            raise TraceError(f"trace: at_end {at_end!r} is unknown; one of {', '.join(AT_ENDS)}")
        if not 0.0 <= uplink_share <= 1.0:
            raise TraceError(f"trace: the uplink's share is {uplink_share}; it must lie in 0 to 1")
        return replace(self, at_end=at_end, uplink_share=uplink_share)

    def summary(self) -> dict[str, float | int | str | None]:
        """Statistics as recorded: samples, lost, loss (fraction), mean, std, min, p50 to p99.9, max (s)."""
        arrived = self.recorded[~np.isnan(self.recorded)]
        lost = len(self.recorded) - len(arrived)
        result: dict[str, float | int | str | None] = {
            "kind": self.kind,
            "provenance": self.provenance,
            "samples": len(self.recorded),
            "lost": lost,
            "loss": lost / len(self.recorded),
            "duration": self.duration,
        }
        if len(arrived):
            result["mean"], result["std"] = float(arrived.mean()), float(arrived.std())
            for name, percent in QUANTILES.items():
                result[name] = float(np.percentile(arrived, percent))
        return result


QUANTILES = {"min": 0, "p5": 5, "p50": 50, "p95": 95, "p99": 99, "p99.9": 99.9, "max": 100}


def load_trace(  # noqa: PLR0913 (what a user may say of a file, each by its name)
    path: str | Path,
    *,
    format: str | None = None,
    unit: str | None = None,
    column: str | None = None,
    period: float | None = None,
    kind: Kind | None = None,
    gap: Gap = "auto",
    time_unit: str | None = None,
    decimal: Decimal | None = None,
    lost: str | None = None,
    sort: bool = False,
) -> Trace:
    """Read a trace of delays.

    Args:
        path: the file.
        format: name of a format (formats/registry.py); None looks at the content.
        unit: of the delays (s, ms, us, ns), where the file does not say it or says it wrong.
        column: the delay's column by name, or by number from 1.
        period: of evenly spaced samples, and of slots (s).
        kind: "one-way" or "round-trip", where the file and its format do not say it.
        gap: what a lost message means; see Trace. "auto" is "loss", and judges by the times whether rows are missing
            (gaps.py); the others say that they are, or that they are not.
        time_unit: of the times, where the file does not say it or says it wrong.
        decimal: "comma" or "point", where a number such as 1,234 can be read in two ways.
        lost: how the file writes a lost message, such as 0 or -1; "none": a delay of 0 is a delay.
        sort: put rows in order that are not.

    Raises:
        TraceError: one line that names the file, the line's number and what is wrong with it.
    """
    name = str(path)
    for word, value, allowed in (
        ("unit", unit, UNITS),
        ("kind", kind, KINDS),
        ("gap", gap, GAPS),
        ("time_unit", time_unit, UNITS),
        ("decimal", decimal, DECIMALS),
    ):
        if value is not None and value not in allowed:
            raise TraceError(f"trace {name}: {word} {value!r} is unknown; one of {', '.join(allowed)}")
    if period is not None and not (math.isfinite(period) and period > 0):
        raise TraceError(f"trace {name}: the period is {period} s; it must be positive")
    text = read_text(path)
    chosen = format_called(format, f"trace {name}") if format else format_of(text)
    text.how("format", f"{chosen.name} ({'as said' if format else 'by its content'})")
    samples = chosen.read(text, TraceOptions(unit, column, period, kind, time_unit, decimal, lost, sort))
    text.reading.how.setdefault("kind", samples.kind)
    recorded = _checked(samples, text)
    text.reading.lost_inferred = samples.inferred
    text.reading.lost_seen = int(np.isnan(recorded).sum()) - samples.inferred
    times = None
    if samples.times is not None:
        recorded = _ordered(samples, recorded, sort, text)
        recorded, times = without_gaps(samples, recorded, gap, text)
    elif gap == "delay" and samples.period is None and np.isnan(recorded).any():
        text.fail("holding lost messages (gap=delay) needs the times or the period of the samples")
    return Trace(
        recorded,
        times,
        samples.period,
        samples.kind,
        samples.provenance,
        "loss" if gap == "auto" else gap,
        reading=text.reading,
    )


def _ordered(
    samples: TraceSamples, recorded: NDArray[np.float64], sort: bool, text: TraceText
) -> NDArray[np.float64]:
    """The delays in the order of their times, which are put in order; raises TraceError unless `sort` allows it."""
    times = np.array(samples.times, dtype=np.float64)
    if not np.isfinite(times).all():
        text.fail("its format gave a time that is not finite")
    back = np.nonzero(np.diff(times) < 0)[0]
    if not len(back):
        return recorded
    if not sort:
        line = samples.lines[int(back[0]) + 1] if samples.lines else None
        text.fail(
            f"the time goes backwards (at {len(back)} places in all); if rows are out of order, say sort=yes (--sort)",
            line,
        )
    order = np.argsort(times, kind="stable")
    samples.times = times[order].tolist()
    text.say(f"rows were out of order at {len(back)} places: put in the order of their times")
    return recorded[order]


def _checked(samples: TraceSamples, text: TraceText) -> NDArray[np.float64]:
    """The delays that a format gave, as an array; raises TraceError where they are no trace."""
    count = len(samples.delays)
    if not count:
        text.fail("; ".join(["no samples", *text.reading.notes]))
    if count > MAX_SAMPLES:
        text.fail(f"{count} samples; at most {MAX_SAMPLES} can be read")
    recorded = np.array(samples.delays, dtype=np.float64)
    if np.isnan(recorded).all():
        text.fail("every message is lost; a trace needs at least one delay")
    if np.isinf(recorded).any() or np.nanmin(recorded) < 0:
        text.fail("its format gave a delay that is negative or infinite")
    if samples.times is not None and len(samples.times) != count:
        text.fail(f"its format gave {len(samples.times)} times for {count} delays")
    return recorded
