"""Console, gamepad or bridge to the operator's program, on its own host: what a hand wants now."""

from typing import Annotated, Any, Literal

import msgspec
from msgspec import Meta

from farhand.common.messages.base import ZERO, Message, Name, Quaternion, Stamp, Vector3

Frame = Literal["base", "tool", "view"]
Unit = Literal["share", "si"]
Share = Annotated[float, Meta(ge=0, le=1)]


class Steering(Message, frozen=True, kw_only=True):
    """A hand at a device, some fifty times a second while there is something to say.

    Attributes:
        device: what kind of device it is, for people.
        engaged: whether a hand holds it down now.
        press: counts the presses of this session; the first is 1. What was let go moves again only by a new one.
        linear: wanted velocity of the tool, shares -1..1 of the fastest or m/s.
        angular: wanted angular velocity of the tool, shares -1..1 of the fastest or rad/s.
        unit: what the two are in: `share` or `si`.
        frame: whose axes they are along.
        view: orientation of the view in base, where `frame` is that one.
        scale: what both are multiplied by.
        estop: stop the robot for good.
        acknowledge: the robot's stop was seen, and is cleared.
        take: asks for the wheel, if nobody has it.
        release: gives the wheel up.
    """

    device: Name
    engaged: bool = False
    press: Stamp = 0
    linear: Vector3 = ZERO
    angular: Vector3 = ZERO
    unit: Unit = "share"
    frame: Frame = "base"
    view: Quaternion = (1.0, 0.0, 0.0, 0.0)
    scale: Share = 1.0
    estop: bool = False
    acknowledge: bool = False
    take: bool = False
    release: bool = False


NOTHING = Steering(source="-", session=0, seq=0, t_sent_ns=0, device="-")
"""What a hand wants that wants nothing, before it travels."""


def unsent(**wanted: Any) -> Steering:
    """What a hand wants, before it travels: whoever sends it fills in who it is and when."""
    return msgspec.structs.replace(NOTHING, **wanted)
