"""The settings of the camera: where it stands, what it looks at, how large and how often its pictures are."""

import math
import re
from dataclasses import dataclass
from typing import Annotated

from msgspec import Meta

from farhand.common.errors import InputError
from farhand.common.messages.base import Vector3
from farhand.common.scenario.section import Section
from farhand.robot_side.camera.strip import LEAST_HEIGHT, LEAST_WIDTH

MOST_WIDTH, MOST_HEIGHT = 1920, 1080
LEAST_RATE, MOST_RATE = 0.5, 60.0
LEAST_QUALITY, MOST_QUALITY = 10, 95
DEVICE = "device:"
VIEW = "pybullet"
OFF = "off"
_SIZE = re.compile(r"(\d{1,5})x(\d{1,5})\Z")
_LEAST_DISTANCE = 0.05  # m between eye and what it looks at


class CameraSettings(Section, frozen=True, kw_only=True):
    """The view of the simulated robot.

    Attributes:
        eye: where it is seen from (m, base).
        look_at: what is in the middle of the picture (m, base).
        up: what is up in the picture, not along the line of sight (base).
        field_of_view: from the picture's foot to its head (rad).

    Raises:
        ValueError: no view can be had from there.
    """

    eye: Vector3 = (1.25, -0.95, 0.85)
    look_at: Vector3 = (0.25, 0.0, 0.3)
    up: Vector3 = (0.0, 0.0, 1.0)
    field_of_view: Annotated[float, Meta(ge=0.1, le=2.5)] = 0.7

    def __post_init__(self) -> None:
        """Raise ValueError where the eye is where it looks, or up is the way it looks."""
        x, y, z = (a - e for a, e in zip(self.look_at, self.eye, strict=True))
        u, v, w = self.up
        distance = math.sqrt(x * x + y * y + z * z)
        if not distance >= _LEAST_DISTANCE:
            raise ValueError(
                f"look_at: is {distance:.3f} m from eye; at least {_LEAST_DISTANCE} m are needed"
            )
        across = math.sqrt((y * w - z * v) ** 2 + (z * u - x * w) ** 2 + (x * v - y * u) ** 2)
        if not across > 1e-3 * distance * math.sqrt(u * u + v * v + w * w):
            raise ValueError("up: is zero, or along the line from eye to look_at; choose another")


@dataclass(frozen=True, slots=True, kw_only=True)
class Pictures:
    """Attributes:
    width, height: in pixels.
    rate_hz: pictures a second.
    quality: of the JPEG, 10 to 95.
    """

    width: int = 320
    height: int = 240
    rate_hz: float = 20.0
    quality: int = 80


def pictures(size: str, rate: float, quality: int) -> Pictures:
    """What is asked for, e.g. `640x480`, 10.0, 80; raises InputError."""
    match = _SIZE.match(size)
    if match is None:
        raise InputError(f"--size {size!r}: expected WIDTHxHEIGHT such as 320x240")
    width, height = int(match[1]), int(match[2])
    if not (LEAST_WIDTH <= width <= MOST_WIDTH and LEAST_HEIGHT <= height <= MOST_HEIGHT):
        raise InputError(
            f"--size {size}: must be from {LEAST_WIDTH}x{LEAST_HEIGHT} to {MOST_WIDTH}x{MOST_HEIGHT} pixels"
        )
    if not LEAST_RATE <= rate <= MOST_RATE:
        raise InputError(f"--rate {rate:g}: must be {LEAST_RATE:g} to {MOST_RATE:g} pictures a second")
    if not LEAST_QUALITY <= quality <= MOST_QUALITY:
        raise InputError(f"--quality {quality}: must be {LEAST_QUALITY} to {MOST_QUALITY}")
    return Pictures(width=width, height=height, rate_hz=rate, quality=quality)


def check_camera(name: str, *, may_be_off: bool = False) -> str:
    """The name itself if it is `pybullet` or `device:PATH`, or `off` where that means something; raises InputError."""
    if name == VIEW or (name == OFF and may_be_off) or (name.startswith(DEVICE) and len(name) > len(DEVICE)):
        return name
    off = ", or off" if may_be_off else ""
    raise InputError(f"--camera {name!r}: must be pybullet, or device:PATH such as device:/dev/video0{off}")
