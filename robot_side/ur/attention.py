"""What changed at the controller so that an operator must know of it before the arm moves on."""

from typing import Any

from farhand.robot_side.ur.settings import UrSettings

SETTLED = 0.01
"""Difference of two speed scalings that are the same."""
FOLLOWS = 0.3
"""s, in which the scaling in force follows the slider."""
SAME_PAYLOAD = 0.005
"""kg."""


class Attention:
    """Calls for it at first, and once for each change: the arm stops, and goes on after an acknowledgement.

    Args:
        settings: the payload that the scenario says.
    """

    def __init__(self, settings: UrSettings) -> None:
        self._payload_wanted = settings.payload
        self._new = True
        self._fraction = 1.0
        self._changed: tuple[float, float] | None = None  # to what, and when by the controller's clock (s)
        self._payload: float | None = None

    def calls(self, values: dict[str, Any]) -> str:
        """What an operator must know now; empty: nothing new.

        Args:
            values: RTDE's outputs, while our program runs.
        """
        if self._new:
            self._new = False
            return "the robot's program has just started: acknowledge to drive"
        return self._scaling(values) or self._mass(values)

    def _scaling(self, values: dict[str, Any]) -> str:
        fraction = float(values["target_speed_fraction"])
        if abs(fraction - self._fraction) < SETTLED:
            self._changed = None
            return ""
        now = float(values["timestamp"])
        if self._changed is None or abs(self._changed[0] - fraction) >= SETTLED:
            self._changed = fraction, now
        if now - self._changed[1] >= FOLLOWS:
            self._fraction = fraction
        return f"speed scaling is {fraction:.0%} now: commanded speeds take effect by so much"

    def _mass(self, values: dict[str, Any]) -> str:
        payload = values.get("payload")
        if payload is None:
            return ""
        if self._payload_wanted is not None and abs(payload - self._payload_wanted) > SAME_PAYLOAD:
            return f"payload: the controller has {payload:g} kg, the scenario {self._payload_wanted:g} kg"
        before, self._payload = self._payload, float(payload)
        if before is None or abs(payload - before) <= SAME_PAYLOAD:
            return ""
        return f"payload: the controller has {payload:g} kg now, it had {before:g} kg"
