"""A fixed margin for the worst case: how far the tool gets before an answer to what is seen now can take effect.

S = K T + C of ISO 13855:2010, "Positioning of safeguards with respect to the approach speeds of parts of the human
body", here with the tool as what approaches: it needs no measurement of the network, and pays for the worst always.
"""

from typing import ClassVar

from farhand.common.messages.base import NonNegative, Positive
from farhand.common.scenario.section import Section
from farhand.operator_side.margins.law import Margin, MarginInput, MarginLaw


class WorstCaseSettings(Section, frozen=True, kw_only=True):
    """Attributes:
    speed: K, the greatest that is asked for (m/s).
    delay: T, the longest from a state to the command that answers it (s).
    extra: C, what is added besides (m).
    """

    speed: Positive = 0.5
    delay: Positive = 0.5
    extra: NonNegative = 0.0


class WorstCaseMargin(MarginLaw):
    """inflation = K T + C, whatever the network does."""

    Settings: ClassVar[type[Section]] = WorstCaseSettings
    predictor = "none"

    def evaluate(self, given: MarginInput) -> Margin:
        """See MarginLaw."""
        settings: WorstCaseSettings = self.settings
        way = settings.speed * settings.delay
        return Margin(inflation=way + settings.extra, parts={"worst-case": way, "extra": settings.extra})
