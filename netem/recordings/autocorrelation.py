"""How much a trace's delays have to do with those shortly before."""

import math

import numpy as np
from numpy.typing import NDArray

LAGS = (1, 2, 5, 10, 20, 50, 100)


def autocorrelation(delays: NDArray[np.float64], lags: tuple[int, ...] = LAGS) -> dict[int, float]:
    """Correlation of delays (n,) with those `lag` samples later, lost ones left out; NaN if undefined."""
    result: dict[int, float] = {}
    for lag in lags:
        before, after = delays[:-lag], delays[lag:]
        both = ~np.isnan(before) & ~np.isnan(after)
        before, after = before[both], after[both]
        if len(before) < 3 or np.ptp(before) == 0 or np.ptp(after) == 0:
            result[lag] = math.nan
        else:
            result[lag] = float(np.corrcoef(before, after)[0, 1])
    return result
