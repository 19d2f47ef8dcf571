"""The interface of every margin law: how much more than d_min to keep, given how bad the network is.

Two quantities: `sigma` is subtracted from the barrier as the paper prints it (arXiv 2403.18650), `inflation` is added
to every obstacle's radius (m).
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import Any, ClassVar

from farhand.common.scenario.section import NoSettings, Section


@dataclass(frozen=True, slots=True)
class MarginInput:
    """What a margin law may look at.

    Attributes:
        speed: of the tool, as last reported (m/s).
        rtt_mean, rtt_std: over the window (s).
        innovation: largest prediction error of the window (m).
        spread: what further losses could make of the newest prediction (m).
        rtt_newest: the newest round trip (s); 0 before the first.
        age: of the oldest command that nothing has answered yet (s): echoes are blind during an outage, this is not.
        loss: fraction of the robot's states of the last seconds that never came; 0 before that is known.
        period: from one command to the next (s).
    """

    speed: float
    rtt_mean: float
    rtt_std: float
    innovation: float
    spread: float
    rtt_newest: float = 0.0
    age: float = 0.0
    loss: float = 0.0
    period: float = 0.1


@dataclass(frozen=True, slots=True)
class Margin:
    """Attributes:
    sigma: subtracted from the barrier.
    inflation: added to the radii (m).
    parts: where it comes from, by name.
    """

    sigma: float = 0.0
    inflation: float = 0.0
    parts: dict[str, float] = field(default_factory=dict)


class MarginLaw(ABC):
    """A margin law. One small file, and one line in registry.py or an entry point in `farhand.margins`.

    Args:
        settings: the law's own, an instance of its `Settings`.

    Attributes:
        Settings: the type of its own settings, read from the table `[margin.NAME]`.
        resyncs: whether the operator's side stands still while the robot leaves commands unanswered for too long.
        predictor: name of the prediction law that it is made for, in force where no other is asked for.
    """

    Settings: ClassVar[type[Section]] = NoSettings
    resyncs: ClassVar[bool] = False
    predictor: ClassVar[str] = "history"

    def __init__(self, settings: Any) -> None:
        self.settings = settings

    @abstractmethod
    def evaluate(self, given: MarginInput) -> Margin:
        """The margin for this tick; must not raise."""

    def round_trip(self, given: MarginInput) -> float | None:
        """The longest round trip that this tick's margin pays for (s); None: it does not reckon with round trips."""
        return None
