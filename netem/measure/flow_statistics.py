"""What became of messages, counted in bounded memory."""

from collections import Counter

from farhand.netem.measure.histogram import Histogram
from farhand.netem.measure.result import FlowCounts

_COUNTERS = ("received", "duplicated", "delivered", "queued", "corrupted", "reordered", "retransmitted")


class FlowStatistics:
    """Counts one robot's messages in one direction; the attributes are FlowCounts'."""

    def __init__(self) -> None:
        self.received = 0
        self.duplicated = 0
        self.delivered = 0
        self.queued = 0
        self.dropped: Counter[str] = Counter()
        self.corrupted = 0
        self.reordered = 0
        self.retransmitted = 0
        self.drawn = Histogram()
        self.achieved = Histogram()
        self.error = Histogram()

    def merge(self, other: "FlowStatistics") -> None:
        """Add all of another's."""
        for name in _COUNTERS:
            setattr(self, name, getattr(self, name) + getattr(other, name))
        self.dropped.update(other.dropped)
        for name in ("drawn", "achieved", "error"):
            getattr(self, name).merge(getattr(other, name))

    def conserved(self) -> bool:
        """Whether received + duplicated = delivered + dropped + queued."""
        return self.received + self.duplicated == self.delivered + sum(self.dropped.values()) + self.queued

    def summary(self) -> FlowCounts:
        """What was counted so far."""
        return FlowCounts(
            **{name: getattr(self, name) for name in _COUNTERS},
            dropped=dict(sorted(self.dropped.items())),
            drawn=self.drawn.summary(),
            achieved=self.achieved.summary(),
            error=self.error.summary(),
        )
