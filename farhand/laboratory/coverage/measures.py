"""What the commands of a drive say of a margin law: how often it held, and how wide it was."""

from collections.abc import Collection

import msgspec
import numpy as np

from farhand.laboratory.coverage.observer import Chosen


class Coverage(msgspec.Struct, frozen=True, kw_only=True):
    """Attributes:
    commands: that left while the robot was driven.
    applied: of these, took effect.
    within: share of the applied whose prediction was off by no more than the margin; None: none was applied.
    error_95, error_most: of the prediction (m).
    width_mean, width_95: of the margin (m).
    answered_within: share of all that were answered within the round trip that was reckoned with, those never
        answered not; None: the law does not reckon with round trips.
    reckoned_mean: the round trip that was reckoned with (s).
    answered_mean, answered_most: until an answer came (s).
    """

    commands: int
    applied: int
    within: float | None
    error_95: float | None
    error_most: float | None
    width_mean: float | None
    width_95: float | None
    answered_within: float | None
    reckoned_mean: float | None
    answered_mean: float | None
    answered_most: float | None


def coverage_of(commands: Collection[Chosen]) -> Coverage:
    """Of the commands of one drive, or of several."""
    applied = [each for each in commands if each.error is not None]
    errors = np.array([each.error for each in applied], dtype=float)
    held = [each.error <= each.width for each in applied if each.error is not None]
    widths = np.array([each.width for each in commands], dtype=float)
    judged = [each for each in commands if each.reckoned is not None]
    in_time = [
        each.answered is not None and each.reckoned is not None and each.answered <= each.reckoned
        for each in judged
    ]
    answered = np.array([each.answered for each in commands if each.answered is not None], dtype=float)
    reckoned = np.array([each.reckoned for each in judged], dtype=float)
    return Coverage(
        commands=len(commands),
        applied=len(applied),
        within=float(np.mean(held)) if held else None,
        error_95=_quantile(errors, 0.95),
        error_most=_quantile(errors, 1.0),
        width_mean=float(np.mean(widths)) if len(widths) else None,
        width_95=_quantile(widths, 0.95),
        answered_within=float(np.mean(in_time)) if in_time else None,
        reckoned_mean=float(np.mean(reckoned)) if len(reckoned) else None,
        answered_mean=float(np.mean(answered)) if len(answered) else None,
        answered_most=_quantile(answered, 1.0),
    )


def _quantile(values: "np.ndarray[tuple[int], np.dtype[np.float64]]", share: float) -> float | None:
    return float(np.quantile(values, share)) if len(values) else None
