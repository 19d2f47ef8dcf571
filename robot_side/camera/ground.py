"""The ground that a view stands on, a grid in base's plane z = 0, and planes that are obstacles.

As camera and planes stand still they are drawn once; the renderer would need several times as long for them as for arm
and obstacles together, picture after picture.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from farhand.common.geometry import Array
from farhand.common.messages.scene import Obstacle
from farhand.common.shapes.pose import rotation
from farhand.robot_side.camera.strip import Picture

CELL, LINE = 0.1, 0.004  # m
_Colour: TypeAlias = tuple[int, int, int]
_AWAY, _GROUND, _MARK = (23, 28, 36), (46, 54, 66), (70, 80, 94)
_PLANE, _PLANE_MARK = (92, 70, 34), (140, 104, 40)
_FADED_AT = 3.0  # m from the base


@dataclass(frozen=True, slots=True)
class Eye:
    """A pinhole camera.

    Attributes:
        position: (3,), m, base.
        right, up, forward: (3,) unit vectors of the picture's axes, base.
        half_height: of the picture at a distance of 1 (its half field of view's tangent).
    """

    position: Array
    right: Array
    up: Array
    forward: Array
    half_height: float

    def rays(self, width: int, height: int) -> Array:
        """(height, width, 3): the way through each pixel, base, one long along `forward`."""
        y = (1.0 - (2.0 * np.arange(height) + 1.0) / height) * self.half_height
        x = ((2.0 * np.arange(width) + 1.0) / width - 1.0) * self.half_height * width / height
        rays: Array = (
            self.forward + x[None, :, None] * self.right[None, None] + y[:, None, None] * self.up[None, None]
        )
        return rays


@dataclass(frozen=True, slots=True)
class Backdrop:
    """What stands behind all that is drawn: planes with a grid on them.

    Attributes:
        picture: (height, width, 4).
        depth: (height, width), m along the eye's `forward`; infinite where there is none.
    """

    picture: Picture
    depth: npt.NDArray[np.float32]


def backdrop(eye: Eye, width: int, height: int, planes: Sequence[Obstacle] = ()) -> Backdrop:
    """The ground, and planes that are obstacles, whichever is nearer to the eye."""
    rays = eye.rays(width, height)
    picture = np.full((height, width, 4), 255, np.uint8)
    picture[:, :, :3] = _AWAY
    found = Backdrop(picture, np.full((height, width), np.inf, np.float32))
    _add(found, eye, rays, np.zeros(3), np.eye(3), (_GROUND, _MARK))
    found.depth[:] = np.inf  # nobody stands on it: it hides nothing, also not what lies below
    for plane in planes:
        R = np.array(rotation(plane.orientation))
        _add(found, eye, rays, np.array(plane.position), R, (_PLANE, _PLANE_MARK))
    return found


def _add(
    found: Backdrop, eye: Eye, rays: Array, place: Array, R: Array, colours: tuple[_Colour, _Colour]
) -> None:
    """Draw the plane z = 0 of a frame at `place`, turned by R (3, 3), where nothing nearer is."""
    ahead, towards = rays @ R[:, 2], float((place - eye.position) @ R[:, 2])
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = np.where(ahead * towards > 0.0, towards / ahead, np.inf)
    there = np.isfinite(depth) & (depth < found.depth)
    at = (eye.position + rays * np.where(there, depth, 0.0)[:, :, None] - place) @ R[:, :2]
    marked = np.any(np.abs((at + CELL / 2.0) % CELL - CELL / 2.0) < LINE / 2.0, axis=2)
    share = np.clip(1.0 - np.hypot(at[:, :, 0], at[:, :, 1]) / _FADED_AT, 0.0, 1.0)[:, :, None]
    mixed = share * np.where(marked[:, :, None], colours[1], colours[0]) + (1.0 - share) * np.array(_AWAY)
    found.picture[there, :3] = mixed.round().astype(np.uint8)[there]
    found.depth[there] = depth[there]
