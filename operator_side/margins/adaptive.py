"""Farhand's own margin: it pays for what predictions get wrong, not for delay as such."""

from typing import ClassVar

from farhand.common.messages.base import NonNegative, Positive
from farhand.common.scenario.section import Section
from farhand.operator_side.margins.law import Margin, MarginInput, MarginLaw


class AdaptiveSettings(Section, frozen=True, kw_only=True):
    """Attributes:
    floor, cap: bounds of the inflation (m).
    """

    floor: NonNegative = 0.01
    cap: Positive = 0.4


class AdaptiveMargin(MarginLaw):
    """inflation = max(floor, largest recent innovation, spread), at most cap."""

    Settings: ClassVar[type[Section]] = AdaptiveSettings
    resyncs = True
    predictor = "timeline"

    def __init__(self, settings: AdaptiveSettings) -> None:
        super().__init__(settings)
        self._floor, self._cap = settings.floor, settings.cap

    def evaluate(self, given: MarginInput) -> Margin:
        """See MarginLaw."""
        inflation = min(self._cap, max(self._floor, given.innovation, given.spread))
        parts = {"floor": self._floor, "innovation": given.innovation, "spread": given.spread}
        return Margin(inflation=inflation, parts=parts)
