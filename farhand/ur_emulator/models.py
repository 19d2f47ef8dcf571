"""The arms that can be emulated, with the controllers that they come with."""

import difflib
from dataclasses import dataclass

from farhand.common.errors import InputError
from farhand.robot_side.arm.catalogue import SHAPELESS, unknown_arm


@dataclass(frozen=True, slots=True)
class EmulatedModel:
    """Attributes:
    arm: name in the catalogue of arms.
    title: what the controller calls it.
    rate_hz: cycles a second.
    version: of the software.
    """

    arm: str
    title: str
    rate_hz: float
    version: tuple[int, int, int, int]


FASTEST, SLOWEST = 500.0, 125.0
"""Hz: of the e-Series, and up to which a controller is of a series before it."""
CB3, E_SERIES = (3, 15, 8, 106339), (5, 12, 0, 1101319)
"""Versions of their software."""
MODELS = {
    **{f"ur{size}": EmulatedModel(f"ur{size}", f"UR{size}", SLOWEST, CB3) for size in (3, 5, 10)},
    **{f"ur{size}e": EmulatedModel(f"ur{size}e", f"UR{size}e", FASTEST, E_SERIES) for size in (3, 5)},
}


def emulated_model(name: str) -> EmulatedModel:
    """The model of that name; raises InputError."""
    if name in MODELS:
        return MODELS[name]
    if name.lower() in SHAPELESS:
        raise InputError(
            f"--model {name!r}: {unknown_arm(name)}; --scenario FILE emulates the arm that it has"
        )
    close = difflib.get_close_matches(name, MODELS, n=1)
    hint = f"is {close[0]} meant? " if close else ""
    raise InputError(f"--model {name!r}: cannot be emulated; {hint}there are {', '.join(MODELS)}")
