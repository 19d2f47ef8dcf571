"""A hand at a gamepad: `farhand steer gamepad` reads it, a program of its own, and this hears that program."""

from typing import ClassVar

from farhand.common.scenario.section import Section
from farhand.operator_side.steering.hand.hand_settings import HandSettings
from farhand.operator_side.steering.hand.remote import Remote

STICKS = ("leftx", "lefty", "rightx", "righty", "lefttrigger", "righttrigger")
KEYS = (
    *(
        "a",
        "b",
        "x",
        "y",
        "back",
        "guide",
        "start",
        "leftstick",
        "rightstick",
        "leftshoulder",
        "rightshoulder",
    ),
    *("dpup", "dpdown", "dpleft", "dpright"),
)


class GamepadSettings(HandSettings, frozen=True, kw_only=True):
    """See HandSettings. The names are those of SDL's mapping; a device that SDL has none for has raw names only."""

    NAMED: ClassVar[tuple[str, ...]] = (*STICKS, *KEYS)

    x: str = "-lefty"
    y: str = "-leftx"
    z: str = "righttrigger -lefttrigger"
    roll: str = "dpright -dpleft"
    pitch: str = "-righty"
    yaw: str = "-rightx"
    deadman: str = "rightshoulder"
    estop: str = "b"
    acknowledge: str = "start"
    faster: str = "dpup"
    slower: str = "dpdown"
    turn_frame: str = "back"


class Gamepad(Remote):
    """See Remote."""

    Settings: ClassVar[type[Section]] = GamepadSettings
