"""The ground that a view stands on: a grid in base's plane z = 0, drawn once for a camera that stands still.

The renderer would need twice as long for it as for arm and obstacles together.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from farhand.common.geometry import Array
from farhand.robot_side.camera.strip import Picture

CELL, LINE = 0.1, 0.004  # m
_AWAY, _GROUND, _MARK = (23, 28, 36), (46, 54, 66), (70, 80, 94)
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


def ground(eye: Eye, width: int, height: int) -> tuple[Picture, npt.NDArray[np.float32]]:
    """The empty picture (height, width, 4), and how far along `forward` its ground is (height, width), m."""
    rays = eye.rays(width, height)
    down = -rays[:, :, 2]
    height_of_eye = float(eye.position[2])
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = np.where(down * height_of_eye > 0.0, height_of_eye / down, np.inf)
    on_it = np.isfinite(depth)
    at = eye.position[:2] + rays[:, :, :2] * np.where(on_it, depth, 0.0)[:, :, None]
    marked = np.any(np.abs((at + CELL / 2.0) % CELL - CELL / 2.0) < LINE / 2.0, axis=2)
    share = np.clip(1.0 - np.hypot(at[:, :, 0], at[:, :, 1]) / _FADED_AT, 0.0, 1.0) * on_it
    colour = np.where(marked[:, :, None], _MARK, _GROUND)
    mixed = share[:, :, None] * colour + (1.0 - share[:, :, None]) * np.array(_AWAY)
    picture = np.full((height, width, 4), 255, np.uint8)
    picture[:, :, :3] = mixed.round().astype(np.uint8)
    return picture, np.where(on_it, depth, np.inf).astype(np.float32)
