"""The paper's margin: what the round trip costs at the present speed, and its scatter at the greatest."""

from typing import ClassVar

from farhand.common.messages.base import NonNegative, Positive
from farhand.common.scenario.section import Section
from farhand.operator_side.margins.law import Margin, MarginInput, MarginLaw


class PaperSettings(Section, frozen=True, kw_only=True):
    """Attributes:
    k_sigma: weight of the round trip's standard deviation.
    max_speed: v_max (m/s).
    """

    k_sigma: NonNegative = 1.0
    max_speed: Positive = 0.52


class PaperMargin(MarginLaw):
    """sigma_k = |v_k| mean(RTT) + v_max k_sigma std(RTT)   (arXiv 2403.18650)."""

    Settings: ClassVar[type[Section]] = PaperSettings

    def __init__(self, settings: PaperSettings) -> None:
        super().__init__(settings)
        self._k_sigma, self._max_speed = settings.k_sigma, settings.max_speed

    def evaluate(self, given: MarginInput) -> Margin:
        """See MarginLaw."""
        delay = given.speed * given.rtt_mean
        jitter = self._max_speed * self._k_sigma * given.rtt_std
        return Margin(sigma=delay + jitter, parts={"delay": delay, "jitter": jitter})

    def round_trip(self, given: MarginInput) -> float | None:
        """See MarginLaw."""
        return given.rtt_mean + self._k_sigma * given.rtt_std
