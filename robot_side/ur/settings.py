"""What `[robot.ur]` may say."""

import socket
from typing import Annotated, Literal

from msgspec import Meta

from farhand.common.errors import InputError
from farhand.common.quantities import Vector3
from farhand.common.scenario.section import Section

Mass = Annotated[float, Meta(ge=0, le=30)]
Offset = tuple[float, float, float, float, float, float]


def address_of(host: str) -> str:
    """The address of a controller by its name, once and for all: no control loop asks for names. Raises InputError."""
    try:
        return socket.gethostbyname(host)
    except (OSError, UnicodeError) as error:
        raise InputError(f"host {host!r}: no address is known by that name: {error}") from None


class UrSettings(Section, frozen=True, kw_only=True):
    """Of a UR arm.

    Attributes:
        payload: that the arm carries (kg); it is set in the controller, and read back. None: what the controller has.
        payload_cog: its centre of gravity, in the flange's frame (m); None: at the flange.
        tcp: tool's centre point from the flange: x, y, z (m), rotation vector (rad); None: what the controller has.
        deadline: what stops the arm when Farhand falls silent: `script`, a program of Farhand's own, by an ordinary
            stop; or `watchdog`, the controller's, by a protective stop.
        deadline_time: silence that `script` allows (s).
    """

    payload: Mass | None = None
    payload_cog: Vector3 | None = None
    tcp: Offset | None = None
    deadline: Literal["script", "watchdog"] = "script"
    deadline_time: Annotated[float, Meta(ge=0.02, le=0.1)] = 0.06
