"""Periods without drift."""


class Periodic:
    """Absolute deadlines of a periodic activity: no drift, missed periods are counted as overruns.

    Args:
        period_ns: the period.
    """

    def __init__(self, period_ns: int) -> None:
        if period_ns <= 0:
            raise ValueError("a period must be positive")
        self.period_ns = period_ns
        self.next_ns: int | None = None
        self.overruns = 0

    def due(self, now_ns: int) -> int:
        """Number of periods that have come due at `now_ns` (0: none); the first call starts the series."""
        if self.next_ns is None:
            self.next_ns = now_ns + self.period_ns
            return 1
        if now_ns < self.next_ns:
            return 0
        periods = (now_ns - self.next_ns) // self.period_ns + 1
        self.overruns += periods - 1
        self.next_ns += periods * self.period_ns
        return periods
