"""Slower as the round trip grows: what those do by hand who drive a robot whose servo knows nothing of the network.

speed = min(1, T / RTT) of what is asked, so that the way driven during a round trip never gets longer than at RTT = T.
People slow down by themselves as the delay grows, and in the end move and wait: W. R. Ferrell, T. B. Sheridan,
"Supervisory control of remote manipulation", IEEE Spectrum 4(10), 1967; MoveIt Servo leaves the factor to its user
(`scale.linear`).
"""

from dataclasses import replace
from typing import Any, ClassVar

from msgspec import field

from farhand.common.messages.base import Positive
from farhand.common.scenario.section import Fraction, Section
from farhand.operator_side.steering.device import SteeringDevice, SteeringInput, View
from farhand.operator_side.steering.settings import SteeringSettings


class PacedSettings(Section, frozen=True, kw_only=True):
    """Attributes:
    device: what steers.
    settings: its own.
    full_until: T, the round trip up to which nothing is slowed (s).
    slowest: share of the speed that is always left.
    """

    device: str = "tester"
    settings: dict[str, Any] = field(default_factory=dict)
    full_until: Positive = 0.1
    slowest: Fraction = 0.05


class Paced(SteeringDevice):
    """Another device, slowed down by the round trip as the newest state shows it: its echo, and how old that is."""

    Settings: ClassVar[type[Section]] = PacedSettings
    acknowledges_itself: ClassVar[bool] = True

    def __init__(self, settings: PacedSettings) -> None:
        super().__init__(settings)
        from farhand.operator_side.steering.registry import make_device

        self._own = settings
        own = {settings.device: settings.settings}
        self._device = make_device(SteeringSettings(kind=settings.device, own=own))

    def read(self, view: View) -> SteeringInput:
        """See SteeringDevice."""
        asked = self._device.read(view)
        self.over = self._device.over
        echo = view.state.echo
        if echo is None:
            return asked
        rtt = (view.now_ns - echo.t_sent_ns - echo.hold_ns) * 1e-9
        share = 1.0 if rtt <= self._own.full_until else max(self._own.slowest, self._own.full_until / rtt)
        x, y, z = asked.velocity
        a, b, c = asked.angular
        return replace(
            asked,
            velocity=(x * share, y * share, z * share),
            angular=(a * share, b * share, c * share),
        )
