"""Recordings with gaps: missing rows become lost messages, and pauses of the recording are cut out.

Whether a row that is not there is a lost message is not said by most files. Where the format says so, it is one; where
every message has a row, it is none. Otherwise the times must tell: of a sender as regular as a clock, whose silences
are few and follow no pattern. Where they do not tell, nothing is inferred, and that is said.
"""

from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from farhand.netem.recordings.formats.base import MAX_SAMPLES, TraceSamples, TraceText

Gap = Literal["auto", "loss", "delay", "ignore"]
GAPS: tuple[Gap, ...] = get_args(Gap)

PAUSE = 30.0
"""A silence longer than this (s) is taken for a pause of the recording, and cut out."""
GAP_FACTOR = 1.75
"""Messages are missing where the next comes later than this many median intervals; less is a late sender."""
REGULAR = 0.25
"""So far (of the median interval) an interval of a regular sender may lie from it..."""
REGULAR_SHARE = 0.85
"""... and so many of the intervals, those with missing messages apart, must."""
MOST_MISSING = 0.5
"""Where more would have been lost than this, the sender was not regular."""

Times = NDArray[np.float64]


def without_gaps(
    samples: TraceSamples, recorded: NDArray[np.float64], gap: Gap, text: TraceText
) -> tuple[NDArray[np.float64], Times]:
    """Delays and times with missing rows filled in as lost, and with pauses of the recording cut out."""
    times = np.array(samples.times, dtype=np.float64)
    times -= times[0]
    if len(times) < 3:
        return recorded, times
    intervals = np.diff(times)
    step = float(np.median(intervals))
    if step <= 0:
        if len(times) > 3 and gap == "auto":
            text.say("most times are equal: missing messages cannot be told from them")
        return recorded, times
    paused = intervals > max(PAUSE, 10 * step)
    paused[[index - 1 for index in samples.pauses if 0 < index < len(times)]] = True
    _say_pauses(intervals, paused, text)
    intervals = np.where(paused, step, intervals)
    times = np.concatenate([[0.0], np.cumsum(intervals)])
    missed = np.floor(intervals / step + 2 - GAP_FACTOR).astype(np.int64) - 1
    missing = np.where(intervals > GAP_FACTOR * step, missed, 0)
    if not missing.any() or not _counts(samples, gap, intervals, missing, text):
        return recorded, times
    if len(recorded) + missing.sum() > MAX_SAMPLES:
        text.fail(f"{int(missing.sum())} messages are missing between the times; read it with gap=ignore")
    text.reading.lost_inferred += int(missing.sum())
    at = np.repeat(np.arange(len(missing)), missing)
    rank = np.concatenate([np.arange(1, count + 1) for count in missing[missing > 0]])
    filled_times = times[at] + rank * intervals[at] / (missing[at] + 1)
    return np.insert(recorded, at + 1, np.nan), np.insert(times, at + 1, filled_times)


def _say_pauses(intervals: Times, paused: NDArray[np.bool_], text: TraceText) -> None:
    if paused.any():
        text.say(
            f"pauses of the recording are cut out: {int(paused.sum())}, "
            f"{float(intervals[paused].sum()):.6g} s in all"
        )


def _counts(
    samples: TraceSamples, gap: Gap, intervals: Times, missing: NDArray[np.int64], text: TraceText
) -> bool:
    """Whether the missing rows are lost messages."""
    if gap != "auto":
        return gap != "ignore"
    if samples.rows_missing != "unknown":
        return samples.rows_missing == "lost"
    why = _irregular(intervals, missing)
    total, places = int(missing.sum()), int((missing > 0).sum())
    if why:
        text.say(
            f"the times have {places} silences, in which {total} messages would fit; no loss is inferred from them, as "
            f"{why}: if they are losses, say gap=loss (--gap loss)"
        )
        return False
    text.say(
        f"{total} lost messages are inferred from {places} silences of a regular sender; the file does not say so: "
        "if there are none, say gap=ignore (--gap ignore)"
    )
    return True


def _irregular(intervals: Times, missing: NDArray[np.int64]) -> str:
    """Why silences are not to be counted as losses; empty if they may be."""
    step = float(np.median(intervals))
    usual = intervals[missing == 0]
    if np.mean(np.abs(usual - step) <= REGULAR * step) < REGULAR_SHARE:
        return "the times are irregular"
    if missing.sum() > MOST_MISSING * (len(intervals) + missing.sum()):
        return "more than half of the messages would be lost"
    places = np.nonzero(missing)[0]
    if len(places) >= 4:
        apart, lengths = np.diff(places), missing[places]
        if apart.std() < 0.1 * apart.mean() and lengths.std() < 0.1 * lengths.mean():
            return "they come in a pattern"
    return ""
