"""`loss:P[,CORRELATION%]`: messages lost at random (tc: `loss random 1% 25%`).

A message is lost when a (correlated) standard normal number exceeds the P quantile, so that the rate is
exactly P whatever the correlation; tc-netem's blending changes the rate.
"""

from farhand.netem.impairments.base import ImpairmentContext, LossModel, Transit
from farhand.netem.impairments.delay import CorrelatedNormal, upper_tail


class RandomEvents:
    """Events of a given probability, perhaps correlated.

    Args:
        context: gives the stream.
        name: of the stream.
        probability: of an event.
        correlation: of the underlying normal numbers of neighbouring messages.
    """

    def __init__(self, context: ImpairmentContext, name: str, probability: float, correlation: float) -> None:
        self._rng = context.rng(name)
        self._probability = probability
        self._normal = CorrelatedNormal(self._rng, correlation) if correlation else None

    def draw(self) -> bool:
        """Whether the next one is an event."""
        if self._normal is None:
            return float(self._rng.random()) < self._probability
        return upper_tail(self._normal.draw()) < self._probability


class RandomLoss(LossModel):
    """Independent or correlated losses."""

    def __init__(self, events: RandomEvents) -> None:
        self._events = events

    def loses(self, transit: Transit, instant_ns: int) -> bool:
        """Draw once more."""
        return self._events.draw()
