"""A hand at a SpaceMouse: `farhand steer spacemouse` reads it, a program of its own, and this hears that program."""

from typing import ClassVar

from farhand.common.scenario.section import Section
from farhand.operator_side.steering.hand.hand_settings import HandSettings
from farhand.operator_side.steering.hand.remote import Remote

CAP_AXES = ("capx", "capy", "capz", "caproll", "cappitch", "capyaw")


class SpacemouseSettings(HandSettings, frozen=True, kw_only=True):
    """See HandSettings; `deadman = "cap"` takes the cap itself, pushed off its rest, in place of a button."""

    NAMED: ClassVar[tuple[str, ...]] = CAP_AXES
    HAS_CAP: ClassVar[bool] = True

    x: str = "capx"
    y: str = "capy"
    z: str = "capz"
    roll: str = "caproll"
    pitch: str = "cappitch"
    yaw: str = "capyaw"
    deadman: str = "button0"
    estop: str = "button1"
    rumble: float = 0.0


class Spacemouse(Remote):
    """See Remote."""

    Settings: ClassVar[type[Section]] = SpacemouseSettings
