"""What reads a kind of device, by the kind's name: called with part of the device's name, it raises InputError."""

import importlib.util
from collections.abc import Callable

from farhand.common.errors import InputError
from farhand.operator_side.devices.hid import LACKING as NO_HIDAPI
from farhand.operator_side.devices.hid import SpacemouseSource
from farhand.operator_side.devices.reading import Source
from farhand.operator_side.devices.sdl import LACKING as NO_PYGAME
from farhand.operator_side.devices.sdl import SdlSource

SOURCES: dict[str, Callable[[str], Source]] = {"gamepad": SdlSource, "spacemouse": SpacemouseSource}
_NEEDS = {"gamepad": (("pygame",), NO_PYGAME), "spacemouse": (("hidraw", "hid"), NO_HIDAPI)}


def lacking(kind: str) -> str:
    """What to say where a kind's library is not installed; empty: it is, or the kind needs none."""
    libraries, say = _NEEDS.get(kind, ((), ""))
    there = not libraries or any(importlib.util.find_spec(name) is not None for name in libraries)
    return "" if there else f"--steer {kind}: {say}"


def check_library(kind: str) -> None:
    """Raise InputError where a kind's library is not installed."""
    says = lacking(kind)
    if says:
        raise InputError(says)
