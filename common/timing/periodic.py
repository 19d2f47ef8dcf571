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
        next_ns, period_ns = self.next_ns, self.period_ns
        if next_ns is None:
            self.next_ns = now_ns + period_ns
            return 1
        late_ns = now_ns - next_ns
        if late_ns < 0:
            return 0
        if late_ns < period_ns:  # every tick of a loop that keeps up
            self.next_ns = next_ns + period_ns
            return 1
        periods = late_ns // period_ns + 1
        self.overruns += periods - 1
        self.next_ns = next_ns + periods * period_ns
        return periods
