"""Whether the camera that a person drives by shows anything new."""

FROZEN_AFTER = 1.0
"""Without a picture for so long it is frozen (s)."""
SEVERAL = 2.5
"""So many of a slow camera's own periods are no silence."""
SLOWEST = 4.0
"""s between two pictures of a slow camera"""
GONE_AFTER = 10.0
"""Then there is no camera any more, and one drives without (s)."""


class Sight:
    """Told of every picture as it comes."""

    def __init__(self) -> None:
        self._newest_ns: int | None = None
        self._between = 0.0

    def note(self, arrived_ns: int) -> None:
        """A picture has come."""
        if self._newest_ns is not None:
            self._between = min(SLOWEST, (arrived_ns - self._newest_ns) * 1e-9)
        self._newest_ns = arrived_ns

    def frozen(self, now_ns: int) -> float:
        """For how long the camera has been frozen (s); 0: it is not, or there is none."""
        if self._newest_ns is None:
            return 0.0
        silent = (now_ns - self._newest_ns) * 1e-9
        return silent if max(FROZEN_AFTER, SEVERAL * self._between) < silent < GONE_AFTER else 0.0
