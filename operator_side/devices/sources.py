"""What reads a kind of device, by the kind's name: called with part of the device's name, it raises InputError."""

from collections.abc import Callable

from farhand.operator_side.devices.hid import SpacemouseSource
from farhand.operator_side.devices.reading import Source
from farhand.operator_side.devices.sdl import SdlSource

SOURCES: dict[str, Callable[[str], Source]] = {"gamepad": SdlSource, "spacemouse": SpacemouseSource}
