"""The settings of the watchdog."""

from typing import Annotated

from msgspec import Meta

from farhand.common.messages.base import Positive
from farhand.common.scenario.section import Section

EvadeTimeout = Annotated[float, Meta(ge=0, le=60)]


class SafetySettings(Section, frozen=True, kw_only=True):
    """The watchdog on the robot.

    Attributes:
        max_age: a command built on a state older than this is refused (s).
        command_timeout: without a good command for this long, RUN becomes HOLD (s).
        stop_timeout: without a good command for this long, HOLD becomes STOPPED (s).
        evade_timeout: for so long after that the guard may still step aside from what moves (s), and then until
            nothing is on its way to the robot; 0: not at all.
        lease_timeout: a silent holder loses control after this (s).
        max_speed: commands faster than this in any axis are refused (m/s).
        max_angular_speed: commands that turn the tool faster than this, about whatever axis, are refused (rad/s).
    """

    max_age: Positive = 1.0
    command_timeout: Positive = 0.3
    stop_timeout: Positive = 1.5
    evade_timeout: EvadeTimeout = 10.0
    lease_timeout: Positive = 2.0
    max_speed: Positive = 2.0
    max_angular_speed: Positive = 2.0
