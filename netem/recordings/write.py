"""Write a trace: our CSV, or slots of fixed length."""

import math
from bisect import bisect_right
from pathlib import Path

import numpy as np

from farhand.common.errors import TraceError
from farhand.common.result_file import write_whole
from farhand.netem.recordings.formats.base import MAX_SAMPLES, UNITS
from farhand.netem.recordings.formats.csv_text import MARK
from farhand.netem.recordings.trace import Trace

WRITERS = ("csv", "slots")


def write_trace(
    trace: Trace, path: str | Path, format: str = "csv", *, unit: str = "ms", period: float | None = None
) -> None:
    """Write a trace that `load_trace` reads back.

    Args:
        trace: what to write; delays as recorded.
        path: the new file.
        format: csv (keeps everything) or slots (one value a line, the sample in force at its start).
        unit: of the delays.
        period: length of a slot (s); None: the trace's own, if it has one.

    Raises:
        TraceError: unknown format or unit, slots without a length, a file that cannot be written.
    """
    if format not in WRITERS:
        raise TraceError(f"cannot write format {format!r}; one of {', '.join(WRITERS)}")
    if unit not in UNITS:
        raise TraceError(f"unknown unit {unit!r}; one of {', '.join(UNITS)}")
    if period is not None and not (math.isfinite(period) and period > 0):
        raise TraceError(f"the period is {period} s; it must be positive")
    lines = [f"{MARK}", f"# unit: {unit}", f"# kind: {trace.kind}"]
    if trace.provenance:
        lines.append(f"# provenance: {' '.join(trace.provenance.split())}")
    lines += _slots(trace, unit, period) if format == "slots" else _csv(trace, unit)
    try:
        write_whole(Path(path), "\n".join(lines) + "\n")
    except OSError as error:
        raise TraceError(f"trace {path}: cannot be written: {error.strerror}") from None


def _csv(trace: Trace, unit: str) -> list[str]:
    words = [_word(delay, unit) for delay in trace.recorded.tolist()]
    if trace.times is not None:
        rows = zip(trace.times.tolist(), words, strict=True)
        return ["time,delay", *(f"{instant:.9f},{word}" for instant, word in rows)]
    head = [f"# period: {trace.period!r} s"] if trace.period is not None else []
    return [*head, "delay", *words]


def _slots(trace: Trace, unit: str, period: float | None) -> list[str]:
    period = period or trace.period
    if period is None or trace.duration is None:
        raise TraceError("how long is a slot? Give the period; and slots need a trace with times")
    count = max(1, round(trace.duration / period))
    if count > MAX_SAMPLES:
        raise TraceError(f"{count} slots are more than {MAX_SAMPLES}; choose a longer period")
    times = trace.times
    if times is None:
        times = np.arange(len(trace.recorded), dtype=np.float64) * (trace.period or period)
    starts, delays = times.tolist(), trace.recorded.tolist()
    # Half a nanosecond of grace: a slot's start is a multiple of the period only up to rounding.
    chosen = [delays[max(0, bisect_right(starts, slot * period + 5e-10) - 1)] for slot in range(count)]
    return [f"# period: {period!r} s", *(_word(delay, unit) for delay in chosen)]


def _word(delay: float, unit: str) -> str:
    return "lost" if math.isnan(delay) else f"{delay / UNITS[unit]:.9g}"
