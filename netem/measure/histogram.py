"""Durations in bounded memory."""

import math

from farhand.netem.measure.result import Delays

_BINS_PER_E = 1 / math.log(1.01)
_SECONDS = 1e-9
"""Of a nanosecond. A product, not `to_seconds`: results stay equal to the last bit to those on disk."""


class Histogram:
    """Durations in bins 1% wide; mean, deviation and maximum are exact."""

    def __init__(self) -> None:
        self.count = 0
        self.max_ns = 0
        self._mean = 0.0
        self._squares = 0.0
        self._bins: dict[int, int] = {}

    def add(self, duration_ns: int) -> None:
        """Record one duration >= 0."""
        count = self.count = self.count + 1
        difference = duration_ns - self._mean
        mean = self._mean = self._mean + difference / count
        self._squares += difference * (duration_ns - mean)
        if duration_ns > self.max_ns:
            self.max_ns = duration_ns
        index = int(math.log(duration_ns) * _BINS_PER_E) if duration_ns > 0 else -1
        bins = self._bins
        bins[index] = bins.get(index, 0) + 1

    def merge(self, other: "Histogram") -> None:
        """Add all of another histogram."""
        if not other.count:
            return
        total = self.count + other.count
        difference = other._mean - self._mean
        self._squares += other._squares + difference * difference * self.count * other.count / total
        self._mean += difference * other.count / total
        self.count = total
        self.max_ns = max(self.max_ns, other.max_ns)
        for index, n in dict(other._bins).items():
            self._bins[index] = self._bins.get(index, 0) + n

    @property
    def mean(self) -> float:
        """Mean (s)."""
        return self._mean * _SECONDS

    @property
    def std(self) -> float:
        """Standard deviation (s)."""
        return math.sqrt(max(0.0, self._squares) / self.count) * _SECONDS if self.count else 0.0

    def quantile(self, fraction: float) -> float:
        """The value (s) below which a fraction lies, to 1%; 0 for an empty histogram."""
        below, wanted = 0, fraction * self.count
        for index, n in sorted(self._bins.items()):
            below += n
            if below >= wanted:
                middle = 0.0 if index < 0 else math.exp((index + 0.5) / _BINS_PER_E)
                return min(middle, float(self.max_ns)) * _SECONDS
        return 0.0

    def summary(self) -> Delays:
        """What there is to say of them."""
        return Delays(
            count=self.count,
            mean=self.mean,
            std=self.std,
            p50=self.quantile(0.5),
            p99=self.quantile(0.99),
            max=self.max_ns * _SECONDS,
        )
