"""The settings of a device that a hand moves: what its inputs do, in a scenario's `[steering.gamepad]` and the like."""

from typing import Annotated, ClassVar, Literal

from msgspec import Meta

from farhand.operator_side.steering.hand.inputs import Inputs, read_inputs
from farhand.operator_side.steering.hand.remote import RemoteSettings

AXES = ("x", "y", "z", "roll", "pitch", "yaw")
BUTTONS = ("deadman", "estop", "acknowledge", "faster", "slower", "turn_frame")
RAW = "axis0, button0, hat0x, hat0y, ..."
_RAW = ("axis", "button", "hat")
CAP = "cap"
"""As a deadman, where a device has one: the cap itself, pushed off its rest."""

DeadZone = Annotated[float, Meta(ge=0, lt=1)]
Expo = Annotated[float, Meta(ge=0, le=1)]
Scales = Annotated[tuple[Annotated[float, Meta(gt=0, le=1)], ...], Meta(min_length=1, max_length=16)]


class HandSettings(RemoteSettings, frozen=True, kw_only=True):
    """An axis is a sum of inputs with signs (inputs.py); empty: nothing moves it. So is a button: pressed above 0.5.

    Attributes:
        NAMED: the inputs that have names on this kind of device.
        HAS_CAP: whether `deadman` may be its cap.
        x, y, z: what moves along these axes of `frame`.
        roll, pitch, yaw: what turns about them, right-handed.
        deadman: motion only while it is held; a new press is needed after each release.
        estop: stops the robot for good.
        acknowledge: clears a stop of the robot that is seen.
        faster, slower: the next of `scales`, the one before.
        turn_frame: from base to tool and back.
        dead_zone: of each stick: what is smaller counts as its centre.
        expo: 0 is straight, 1 is cubic.
        scales: shares of `speed` and `turn_speed`, rising; it begins with the largest up to 0.5, if there is one.
        frame: whose axes are meant at the start.
        rumble: how strongly it shakes where nothing is done of what is asked, 0..1.
        name: part of the name of the device to be used; empty: the first one.
    """

    NAMED: ClassVar[tuple[str, ...]] = ()
    HAS_CAP: ClassVar[bool] = False

    x: str = ""
    y: str = ""
    z: str = ""
    roll: str = ""
    pitch: str = ""
    yaw: str = ""
    deadman: str = ""
    estop: str = ""
    acknowledge: str = ""
    faster: str = ""
    slower: str = ""
    turn_frame: str = ""
    dead_zone: DeadZone = 0.12
    expo: Expo = 0.4
    scales: Scales = (0.1, 0.25, 0.5, 0.75, 1.0)
    frame: Literal["base", "tool"] = "base"
    rumble: Expo = 0.6
    name: str = ""

    def __post_init__(self) -> None:
        """Raises ValueError for inputs that cannot be, which reading turns into a message."""
        for field in (*AXES, *BUTTONS):
            try:
                names = self.inputs(field).names
            except ValueError as error:
                raise ValueError(f"{field} {getattr(self, field)!r}: {error}") from None
            for name in names:
                cap = field == "deadman" and self.held_by_cap
                if not self._is_known(name) and not cap:
                    known = ", ".join(self.NAMED)
                    raise ValueError(f"{field}: no such input: {name!r}; there are {known}, and {RAW}")
        if not self.deadman.strip():
            raise ValueError("deadman: must name a button; nothing moves without one")
        if list(self.scales) != sorted(set(self.scales)):
            raise ValueError(f"scales: must rise, such as [0.1, 0.5, 1.0]; here {list(self.scales)}")

    @property
    def held_by_cap(self) -> bool:
        """Whether the deadman is the cap."""
        return self.HAS_CAP and self.deadman == CAP

    def inputs(self, field: str) -> Inputs:
        """What is named by a field that names inputs."""
        return read_inputs(getattr(self, field))

    def _is_known(self, name: str) -> bool:
        return name in self.NAMED or (name.startswith(_RAW) and any(letter.isdigit() for letter in name))
