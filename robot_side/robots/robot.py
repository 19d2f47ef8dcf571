"""The interface of every robot, and what it is sampled as."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from farhand.common.messages.base import Quaternion, Vector3
from farhand.common.messages.scene import Obstacle


@dataclass(frozen=True, slots=True)
class RobotSample:
    """The tool in the base frame, and the joints.

    Attributes:
        position: of the tool (m).
        velocity: of the tool (m/s).
        orientation: of the tool, unit quaternion (w, x, y, z).
        joints: joint positions (rad); empty for robots without joints.
    """

    position: Vector3
    velocity: Vector3
    orientation: Quaternion = (1.0, 0.0, 0.0, 0.0)
    joints: tuple[float, ...] = ()


class Robot(Protocol):
    """A robot that follows tool velocities, one control period at a time."""

    def sample(self) -> RobotSample:
        """The state now."""
        ...

    def step(self, velocity: Vector3, dt: float) -> None:
        """One period of `dt` s under the commanded tool velocity (m/s, base)."""
        ...

    def arm_clearance(self, obstacles: Sequence[Obstacle]) -> float | None:
        """Distance of the whole body to the nearest obstacle (m); None where it is not computed."""
        ...

    def close(self) -> None:
        """Give everything back; the robot is of no use afterwards."""
        ...
