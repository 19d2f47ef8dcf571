"""The settings of the guard."""

from farhand.common.messages.base import NonNegative, Positive
from farhand.common.scenario.section import Section


class GuardSettings(Section, frozen=True, kw_only=True):
    """The guard between watchdog and velocity control; it knows the true state, and where every obstacle is.

    Attributes:
        on: whether there is one.
        d_min: nothing of the robot comes nearer than this to an obstacle, or to another link (m). The guard
            keeps 2 to 3 mm more, for what lies between two ticks.
        acceleration: what a robot without joints can be counted on to brake with (m/s^2); 0: its lag alone says it.
            The guard takes half of it for sure.
    """

    on: bool = True
    d_min: Positive = 0.01
    acceleration: NonNegative = 0.0
