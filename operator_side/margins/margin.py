"""Margin laws: how much more than d_min to keep, given how bad the network is.

Two quantities: `sigma` is subtracted from the barrier as the paper prints it, `inflation` is added to every
obstacle's radius (m).
"""

from dataclasses import dataclass, field
from typing import Protocol

from farhand.common.scenario import ControllerSettings, MarginSettings


@dataclass(frozen=True, slots=True)
class MarginInput:
    """What a margin law may look at.

    Attributes:
        speed: of the tool, as last reported (m/s).
        rtt_mean, rtt_std: over the window (s).
        innovation: largest prediction error of the window (m).
        spread: what further losses could make of the newest prediction (m).
    """

    speed: float
    rtt_mean: float
    rtt_std: float
    innovation: float
    spread: float


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


class MarginLaw(Protocol):
    """A margin law."""

    def evaluate(self, given: MarginInput) -> Margin:
        """The margin for this tick."""
        ...


def make_margin(settings: MarginSettings, controller: ControllerSettings) -> MarginLaw:
    """The law that the settings name."""
    match settings.kind:
        case "none":
            return NoMargin()
        case "paper":
            return PaperMargin(settings, controller)
        case "adaptive":
            return AdaptiveMargin(settings)


class NoMargin:
    """d_min and nothing more."""

    def evaluate(self, given: MarginInput) -> Margin:
        """See MarginLaw."""
        return Margin()


class PaperMargin:
    """sigma_k = |v_k| mean(RTT) + v_max k_sigma std(RTT)   (arXiv 2403.18650)."""

    def __init__(self, settings: MarginSettings, controller: ControllerSettings) -> None:
        self._k_sigma, self._max_speed = settings.k_sigma, controller.max_speed

    def evaluate(self, given: MarginInput) -> Margin:
        """See MarginLaw."""
        delay = given.speed * given.rtt_mean
        jitter = self._max_speed * self._k_sigma * given.rtt_std
        return Margin(sigma=delay + jitter, parts={"delay": delay, "jitter": jitter})


class AdaptiveMargin:
    """inflation = max(floor, largest recent innovation, spread), at most cap.

    It pays for the errors that predictions really make and could make, not for delay as such.
    """

    def __init__(self, settings: MarginSettings) -> None:
        self._floor, self._cap = settings.floor, settings.cap

    def evaluate(self, given: MarginInput) -> Margin:
        """See MarginLaw."""
        inflation = min(self._cap, max(self._floor, given.innovation, given.spread))
        parts = {"floor": self._floor, "innovation": given.innovation, "spread": given.spread}
        return Margin(inflation=inflation, parts=parts)
