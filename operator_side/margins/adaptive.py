"""Farhand's own margin: it pays for what predictions get wrong, not for delay as such."""

from typing import ClassVar

from farhand.common.messages.base import NonNegative, Positive
from farhand.common.scenario.section import Section
from farhand.operator_side.margins.law import Margin, MarginInput, MarginLaw


class AdaptiveSettings(Section, frozen=True, kw_only=True):
    """Attributes:
    floor, cap: bounds of the inflation while the tool moves (m).
    least: what is left of the floor of a tool that stands (m).
    timing: error of time that no innovation has shown yet (s): the floor grows from `least` by the way in it.
    """

    floor: NonNegative = 0.01
    cap: Positive = 0.4
    least: NonNegative = 0.003
    timing: NonNegative = 0.05


class AdaptiveMargin(MarginLaw):
    """inflation = max(min(floor, least + timing |v|), largest recent innovation, spread), at most cap.

    The floor is for errors that the window has not shown yet. They are errors of time, so the way in it is what they
    come to: a tool that creeps needs less, and passes a gap that a constant floor would fill.
    """

    Settings: ClassVar[type[Section]] = AdaptiveSettings
    resyncs = True
    predictor = "timeline"

    def __init__(self, settings: AdaptiveSettings) -> None:
        super().__init__(settings)
        self._floor, self._cap = settings.floor, settings.cap
        self._least, self._timing = settings.least, settings.timing

    def evaluate(self, given: MarginInput) -> Margin:
        """See MarginLaw."""
        floor = min(self._floor, self._least + self._timing * given.speed)
        inflation = min(self._cap, max(floor, given.innovation, given.spread))
        parts = {"floor": floor, "innovation": given.innovation, "spread": given.spread}
        return Margin(inflation=inflation, parts=parts)
