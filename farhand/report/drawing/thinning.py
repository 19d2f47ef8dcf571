"""Fewer points for the same picture: of each stretch the least and the largest stay, so that no minimum is lost."""

import numpy as np
from numpy.typing import NDArray

from farhand.common.geometry import Array

Rows = NDArray[np.intp]

STRETCHES = 600
"""As many as a chart has pixels across, about."""


def thinned(t: Array, values: Array, span: tuple[float, float], stretches: int = STRETCHES) -> Rows:
    """(m,) rows to be drawn, in order: of each stretch of time those of the least and of the largest value.

    Args:
        t: (n,) instants, not falling (s).
        values: (n,) NaN where unknown; those are left out.
        span: of time that is drawn (s).
        stretches: equal parts of it.
    """
    known = np.flatnonzero(np.isfinite(values))
    if len(known) <= 2 * stretches:
        return known
    length = max(span[1] - span[0], 1e-9) / stretches
    place = np.clip(((t[known] - span[0]) / length).astype(int), 0, stretches - 1)
    by_value = np.lexsort((values[known], place))
    groups = place[by_value]
    first = np.flatnonzero(np.diff(groups, prepend=-1))
    last = np.append(first[1:] - 1, len(groups) - 1)
    return np.unique(known[np.concatenate([by_value[first], by_value[last]])])


def highest(t: Array, values: Array, span: tuple[float, float], stretches: int = STRETCHES) -> Rows:
    """(m,) rows of the largest value of each stretch; see thinned."""
    known = np.flatnonzero(np.isfinite(values))
    if len(known) <= stretches:
        return known
    length = max(span[1] - span[0], 1e-9) / stretches
    place = np.clip(((t[known] - span[0]) / length).astype(int), 0, stretches - 1)
    by_value = np.lexsort((values[known], place))
    groups = place[by_value]
    last = np.append(np.flatnonzero(np.diff(groups)), len(groups) - 1)
    return np.unique(known[by_value[last]])
