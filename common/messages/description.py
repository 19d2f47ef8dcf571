"""Robot to operator: what it is. The operator takes lag, radius, rates and limits from here, not from its scenario."""

from typing import Annotated

from msgspec import Meta

from farhand.common.messages.base import Message, Name, NameOrNone, NonNegative, Positive
from farhand.common.messages.state import MAX_JOINTS


class RobotDescription(Message, frozen=True, kw_only=True):
    """Robot to operator, once a second and whenever another one gets control.

    Attributes:
        kind: which robot it is.
        model: name of its model, for those who draw it; empty where there is none.
        joint_names: of `RobotState.joints`, in its order.
        lag: time constant with which the tool follows a velocity command (s).
        radius: of the sphere around the tool that must stay clear (m).
        rate_hz: of its control loop.
        state_rate_hz: of its states.
        max_speed: commands faster than this in any axis are refused (m/s).
        max_angular_speed: commands that turn the tool faster than this are refused (rad/s).
        max_age: commands built on a state older than this are refused (s).
        command_timeout: without a good command for this long it holds (s).
    """

    kind: Name
    model: NameOrNone = ""
    joint_names: Annotated[tuple[Name, ...], Meta(max_length=MAX_JOINTS)] = ()
    lag: NonNegative
    radius: NonNegative
    rate_hz: Positive
    state_rate_hz: Positive
    max_speed: Positive
    max_angular_speed: Positive = 2.0
    max_age: Positive
    command_timeout: Positive

    def same_robot(self, other: "RobotDescription") -> bool:
        """Whether the other one says the same of the robot, whenever it was sent."""
        own = set(RobotDescription.__struct_fields__) - set(Message.__struct_fields__)
        return all(getattr(self, name) == getattr(other, name) for name in own)
