"""A run's curve in bounded memory, however long the run."""

from typing import Generic, TypeVar

T = TypeVar("T")
LIMIT = 32_768
"""At 10 Hz the first 54 minutes are kept as they are, at 50 Hz the first 11."""


class Series(Generic[T]):
    """Samples of an endless sequence, evenly spaced.

    Up to `limit` samples are kept as they come. When they are too many every second one goes, and from then
    on only every second is kept, then every fourth, and so on: the curve stays whole, at half the resolution,
    and always holds the first sample.

    Args:
        limit: samples to keep, 2 or more.
    """

    def __init__(self, limit: int = LIMIT) -> None:
        if limit < 2:
            raise ValueError("a series keeps two samples at least")
        self._limit = limit
        self._every = 1
        self._seen = 0
        self._samples: list[T] = []

    def add(self, sample: T) -> None:
        """Take the next sample."""
        if self._seen % self._every == 0:
            if len(self._samples) == self._limit:
                del self._samples[1::2]
                self._every *= 2
            if self._seen % self._every == 0:
                self._samples.append(sample)
        self._seen += 1

    def samples(self) -> list[T]:
        """Those that are kept, in order."""
        return list(self._samples)
