"""The targets by name. Each is imported when it is asked for, so that a fuzzer can instrument it before."""

import importlib

from farhand.common.errors import InputError
from farhand.trials.fuzz.target import Target

NAMES = (
    "codec",
    "robot-intake",
    "scene-requests",
    "operator-messages",
    "operator-tick",
    "steering",
    "console-page",
    "live-control",
    "requests",
    "answers",
    "network-spec",
    "scenario",
    "timeline",
    "recording",
    "trace",
    "rate-and-model",
    "ros2-cdr",
    "mesh",
    "urdf",
    "ur-rtde-server",
    "ur-rtde-client",
    "ur-script",
    "ur-dashboard",
)
"""In the order of the table."""


def check_name(name: str) -> None:
    """Raise InputError for a target that there is not."""
    if name not in NAMES:
        raise InputError(f"--targets {name!r}: must be some of {','.join(NAMES)}")


def target_called(name: str) -> Target:
    """The target of a name; raises InputError for one that there is not."""
    check_name(name)
    module = importlib.import_module(f"farhand.trials.fuzz.targets.{name.replace('-', '_')}")
    found: Target = module.TARGET
    return found
