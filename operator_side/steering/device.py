"""The interface of everything that steers. Hold-to-run: motion only while the device is engaged."""

from dataclasses import dataclass
from typing import Protocol

from farhand.common.messages.base import Vector3
from farhand.common.messages.scene import Scene
from farhand.common.messages.state import RobotState


@dataclass(frozen=True, slots=True)
class SteeringInput:
    """What the operator wants now.

    Attributes:
        velocity: desired tool velocity, base frame (m/s).
        engaged: motion is allowed only while this holds.
        acknowledge: the operator has seen the robot's stop and clears it.
        estop: the operator wants the robot stopped for good.
    """

    velocity: Vector3 = (0.0, 0.0, 0.0)
    engaged: bool = False
    acknowledge: bool = False
    estop: bool = False


class SteeringDevice(Protocol):
    """A steering device."""

    @property
    def progress(self) -> tuple[int, int]:
        """Targets reached and targets in all; (0, 0) for a device without targets."""
        ...

    @property
    def finished(self) -> bool:
        """Whether there is nothing left to do."""
        ...

    def read(self, state: RobotState, scene: Scene, now_ns: int) -> SteeringInput:
        """What the operator wants, looking at the newest state."""
        ...
