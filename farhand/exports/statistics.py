"""Statistics of a feature, as LeRobot normalises by them."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from farhand.common.geometry import Array


@dataclass(frozen=True, slots=True)
class Statistics:
    """Attributes:
    low, high, mean, std: of each entry, of the shape of the feature.
    count: how many.
    """

    low: Array
    high: Array
    mean: Array
    std: Array
    count: int

    @staticmethod
    def measured(values: npt.NDArray[Any]) -> "Statistics":
        """Of rows of values."""
        rows = np.asarray(values, dtype=float)
        rows = rows[:, None] if rows.ndim == 1 else rows
        return Statistics(rows.min(axis=0), rows.max(axis=0), rows.mean(axis=0), rows.std(axis=0), len(rows))

    @staticmethod
    def of(parts: Sequence["Statistics"]) -> "Statistics":
        """Of all parts together."""
        counts = np.array([part.count for part in parts], dtype=float)
        weights = counts / counts.sum()
        mean = sum(w * part.mean for w, part in zip(weights, parts, strict=True))
        square = sum(
            w * (part.std**2 + (part.mean - mean) ** 2) for w, part in zip(weights, parts, strict=True)
        )
        return Statistics(
            np.min([part.low for part in parts], axis=0),
            np.max([part.high for part in parts], axis=0),
            np.asarray(mean),
            np.sqrt(square),
            int(counts.sum()),
        )

    def plain(self) -> dict[str, Any]:
        """As it is written."""
        named = {"min": self.low, "max": self.high, "mean": self.mean, "std": self.std}
        return {name: values.tolist() for name, values in named.items()} | {"count": [self.count]}
