"""The settings of the rest of the operator's side, and what it reads of a scenario."""

from typing import Annotated, Protocol

from msgspec import Meta

from farhand.common.messages.base import Positive
from farhand.common.scenario.section import Section
from farhand.operator_side.control.settings import ControllerSettings
from farhand.operator_side.margins.settings import MarginSettings
from farhand.operator_side.steering.settings import SteeringSettings


class OperatorSettings(Section, frozen=True, kw_only=True):
    """The rest of the operator's side.

    Attributes:
        predictor: which state prediction; None chooses the one that the margin law is made for.
        resync_after: with the oldest unanswered command older than this, a zero plan is sent (s), by margin
            laws that resynchronise.
        rate_hz: commands a second; a step of the plan, `controller.period`, must be a whole number of ticks.
            None: one a step, 10 Hz with the paper's settings.
        tolerance: a target counts as reached within this distance (m).
    """

    predictor: str | None = None
    resync_after: Positive = 0.8
    rate_hz: Annotated[float, Meta(ge=1, le=500)] | None = None
    tolerance: Positive = 0.02


class OperatorScenario(Protocol):
    """What the operator's side reads of a scenario; robot, obstacles and targets come over the wire."""

    @property
    def controller(self) -> ControllerSettings:
        """The safety filter."""
        ...

    @property
    def margin(self) -> MarginSettings:
        """The margin."""
        ...

    @property
    def operator(self) -> OperatorSettings:
        """The rest."""
        ...

    @property
    def steering(self) -> SteeringSettings:
        """What steers."""
        ...
