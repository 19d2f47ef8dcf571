"""Progress through the task's targets: whoever steers, a target is reached when the tool has been there."""

import math

from farhand.common.messages.base import Vector3
from farhand.common.messages.scene import Scene
from farhand.common.messages.state import RobotState


class Targets:
    """Counts the scene's targets off, in order.

    Args:
        tolerance: a target counts as reached within this distance (m).

    Attributes:
        reached: how many have been.
        count: how many there are; 0 before the first scene.
        next: the one to reach now (m, base); None where there is none.
    """

    def __init__(self, tolerance: float) -> None:
        self._tolerance = tolerance
        self.reached = 0
        self.count = 0
        self.next: Vector3 | None = None

    def update(self, state: RobotState, scene: Scene, *, driving: bool = True) -> None:
        """Look at where the robot last said it was; what it passes while another one is `driving` does not count."""
        self.count = len(scene.targets)
        while driving and self.reached < self.count:
            offset = [t - x for t, x in zip(scene.targets[self.reached], state.position, strict=True)]
            if math.hypot(*offset) > self._tolerance:
                break
            self.reached += 1
        self.next = scene.targets[self.reached] if self.reached < self.count else None

    @property
    def finished(self) -> bool:
        """Whether every target has been reached."""
        return self.count > 0 and self.reached >= self.count
