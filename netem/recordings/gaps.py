"""Recordings with gaps: missing rows become lost messages, and pauses of the recording are cut out."""

from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from farhand.netem.recordings.formats.base import MAX_SAMPLES, TraceSamples, TraceText

Gap = Literal["loss", "delay", "ignore"]
GAPS: tuple[Gap, ...] = get_args(Gap)

PAUSE = 30.0
"""A silence longer than this (s) is taken for a pause of the recording, and cut out."""
GAP_FACTOR = 1.75
"""Messages are missing where the next comes later than this many median intervals; less is a late sender."""


def without_gaps(
    samples: TraceSamples, recorded: NDArray[np.float64], gap: Gap, text: TraceText
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Delays and times with missing rows filled in as lost, and with pauses of the recording cut out."""
    times = np.array(samples.times, dtype=np.float64)
    times -= times[0]
    if len(times) < 3:
        return recorded, times
    intervals = np.diff(times)
    step = float(np.median(intervals))
    if step <= 0:
        return recorded, times
    longest = max(PAUSE, 10 * step)
    paused = intervals > longest
    intervals = np.where(paused, step, intervals)
    times = np.concatenate([[0.0], np.cumsum(intervals)])
    missed = np.floor(intervals / step + 2 - GAP_FACTOR).astype(np.int64) - 1
    missing = np.where(intervals > GAP_FACTOR * step, missed, 0)
    if gap == "ignore" or not missing.any():
        return recorded, times
    if len(recorded) + missing.sum() > MAX_SAMPLES:
        text.fail(f"{int(missing.sum())} messages are missing between the times; read it with gap=ignore")
    at = np.repeat(np.arange(len(missing)), missing)
    rank = np.concatenate([np.arange(1, count + 1) for count in missing[missing > 0]])
    filled_times = times[at] + rank * intervals[at] / (missing[at] + 1)
    return np.insert(recorded, at + 1, np.nan), np.insert(times, at + 1, filled_times)
