"""What stands in a LeRobot dataset's vectors: velocities as they were asked, or places to which they would lead.

A place is the tool's as it was seen, carried on by what was asked for one tick. Together with the place beside it, it
says the same as the velocity does, in the form in which most policies and checkers expect an action.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from farhand.common.geometry import Array, turned
from farhand.exports.episodes import Values, same_side

TWIST = ("x", "y", "z", "angular_x", "angular_y", "angular_z")
PLACE = ("x", "y", "z", "qw", "qx", "qy", "qz")
NOISE = 1e-4
"""m, rad: what changes less in a whole dataset stands still."""
VELOCITY, POSITION = "velocity", "position"
ACTIONS = (VELOCITY, POSITION)
SENT = ("command.filtered", "command.applied")


@dataclass(frozen=True, slots=True)
class Axes:
    """Features on the same axes: what is asked and what the robot does can be held against each other.

    Attributes:
        features: which.
        asked: of them, those that say which axes are used.
        names: of all axes.
    """

    features: tuple[str, ...]
    asked: tuple[str, ...]
    names: tuple[str, ...]


def axes_of(actions: str) -> tuple[Axes, ...]:
    """The features that share axes, by what actions are: velocities, or positions."""
    if actions == VELOCITY:
        return (Axes(("action", *SENT, "observation.state"), ("action", *SENT), TWIST),)
    twists = ("command.asked", *SENT)
    return Axes(twists, twists, TWIST), Axes(("action", "observation.state"), ("observation.state",), PLACE)


def as_positions(values: Values, period: float) -> Values:
    """A frame's features with places for `action` and `observation.state`, and the velocity as `command.asked`.

    Args:
        values: with velocities.
        period: of a tick (s).
    """
    asked, place = values["action"], values["observation.environment_state"][: len(PLACE)]
    position = tuple(at + period * speed for at, speed in zip(place[:3], asked[:3], strict=True))
    w, x, y, z = place[3:]
    a, b, c = (period * speed for speed in asked[3:])
    orientation = same_side((w, x, y, z), turned((w, x, y, z), (a, b, c)))
    return values | {
        "action": (*position, *orientation),
        "command.asked": asked,
        "observation.state": place,
    }


def kept_axes(values: dict[str, Array], shared: Sequence[Axes]) -> dict[str, list[int]]:
    """The entries of each feature that are kept: what never changes teaches nothing, and cannot be normalised.

    Args:
        values: of a whole dataset, a row a frame.
        shared: see axes_of.
    """
    kept = {name: _changing(each, NOISE) for name, each in values.items()}
    turns = False
    for axes in shared:
        of_place = axes.names == PLACE
        used = {i for name in axes.asked for i in _changing(values[name], NOISE if of_place else 0.0)}
        if of_place and not turns:  # what turns by a hair only because it moves is nothing that was asked
            used -= set(range(3, len(PLACE)))
        turns = turns or (not of_place and max(used, default=0) >= 3)
        kept |= dict.fromkeys(axes.features, sorted(used) or [0, 1, 2])
    return {name: entries for name, entries in kept.items() if entries}


def _changing(values: Array, least: float) -> list[int]:
    return [int(i) for i in np.flatnonzero(np.ptp(values, axis=0) > least)]
