"""The paper's margin, made to reckon with what echoes cannot tell: what is unanswered yet, losses, and jumps."""

import math
from typing import Annotated, ClassVar

from msgspec import Meta

from farhand.common.messages.base import NonNegative, Positive
from farhand.common.scenario.section import Section
from farhand.operator_side.margins.law import Margin, MarginInput, MarginLaw


class WatchfulSettings(Section, frozen=True, kw_only=True):
    """Attributes:
    k_sigma: weight of the round trip's standard deviation.
    max_speed: v_max (m/s).
    run_of_losses: probability with which more commands in a row may be lost than are reckoned with.
    """

    k_sigma: NonNegative = 3.0
    max_speed: Positive = 0.52
    run_of_losses: Annotated[float, Meta(gt=0, lt=1)] = 0.01


class WatchfulMargin(MarginLaw):
    """sigma_k = |v_k| mean(RTT) + v_max (T_k - mean(RTT)), with T_k the round trip that is reckoned with:

    T_k = max(mean + k std, newest, age of the oldest unanswered command) + n period,  loss^n <= run_of_losses.

    With T_k = mean + k std it is the paper's (arXiv 2403.18650). The newest round trip counts as it is, for mean and
    deviation learn of a jump over the seconds of their window; n commands in a row may be lost before one is answered.
    """

    Settings: ClassVar[type[Section]] = WatchfulSettings

    def __init__(self, settings: WatchfulSettings) -> None:
        super().__init__(settings)
        self._k_sigma, self._max_speed = settings.k_sigma, settings.max_speed
        self._rare = math.log(settings.run_of_losses)

    def evaluate(self, given: MarginInput) -> Margin:
        """See MarginLaw."""
        delay = given.speed * given.rtt_mean
        jitter = self._max_speed * self._k_sigma * given.rtt_std
        unknown = max(0.0, self._max_speed * (self._longest(given) - given.rtt_mean) - jitter)
        parts = {"delay": delay, "jitter": jitter, "unanswered": unknown}
        return Margin(sigma=delay + jitter + unknown, parts=parts)

    def round_trip(self, given: MarginInput) -> float | None:
        """See MarginLaw."""
        return self._longest(given)

    def _longest(self, given: MarginInput) -> float:
        scattered = given.rtt_mean + self._k_sigma * given.rtt_std
        return max(scattered, given.rtt_newest, given.age) + self._losses(given.loss) * given.period

    def _losses(self, loss: float) -> int:
        """How many commands in a row may be lost."""
        if loss <= 0.0:
            return 0
        return math.ceil(self._rare / math.log(min(loss, MOST)))


MOST = 0.9
"""A loss above it counts as it: with all lost nothing is answered, and the age says so."""
