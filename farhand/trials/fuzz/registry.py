"""The targets by name. Each is imported when it is asked for, so that a fuzzer can instrument it before."""

import importlib

from farhand.common.errors import InputError
from farhand.trials.fuzz.target import Target

TARGETS = "farhand.trials.fuzz.targets"
ROOMS = {
    "wire": (
        "codec", "robot-intake", "scene-requests", "operator-messages", "operator-tick", "steering", "ros2-cdr",
    ),
    "desks": ("console-page", "scene-words", "live-control", "requests", "answers"),
    "files": (
        "network-spec", "scenario", "timeline", "recording", "trace", "rate-and-model", "mesh", "urdf", "srdf",
        "capsules", "sweep",
    ),
    "ur": ("ur-rtde-server", "ur-rtde-client", "ur-script", "ur-dashboard"),
}  # fmt: skip
"""Packages of `targets`, and the names of the targets in each, in the order of the table."""
NAMES = tuple(name for names in ROOMS.values() for name in names)


def check_name(name: str) -> None:
    """Raise InputError for a target that there is not."""
    if name not in NAMES:
        raise InputError(f"--targets {name!r}: must be some of {','.join(NAMES)}")


def target_called(name: str) -> Target:
    """The target of a name; raises InputError for one that there is not."""
    check_name(name)
    room = next(room for room, names in ROOMS.items() if name in names)
    module = importlib.import_module(f"{TARGETS}.{room}.{name.removeprefix('ur-').replace('-', '_')}")
    found: Target = module.TARGET
    return found
