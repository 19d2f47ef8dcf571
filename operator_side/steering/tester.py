"""The paper's tester: heads straight for the next target and ignores every obstacle.

Speed 0.05 m/s within 0.15 m of the target, 0.50 m/s beyond 0.50 m, linear between (arXiv 2403.18650).
"""

import math

from farhand.common.messages.scene import Scene
from farhand.common.messages.state import RobotState
from farhand.common.scenario import OperatorSettings
from farhand.operator_side.steering.device import SteeringInput

ACKNOWLEDGE_PERIOD_NS = 500_000_000


class Tester:
    """Drives through the scene's targets in order; acknowledges a latched stop and control that
    has become free, as a person would, but never an emergency stop.

    Args:
        settings: speeds, distances, tolerance.
    """

    def __init__(self, settings: OperatorSettings) -> None:
        self._settings = settings
        self._index = 0
        self._count = 0
        self._acknowledged_ns: int | None = None

    @property
    def progress(self) -> tuple[int, int]:
        """Targets reached and targets in all."""
        return self._index, self._count

    @property
    def finished(self) -> bool:
        """Whether every target has been reached."""
        return self._count > 0 and self._index >= self._count

    def read(self, state: RobotState, scene: Scene, now_ns: int) -> SteeringInput:
        """Straight towards the next target, from where the robot last said it was."""
        self._count = len(scene.targets)
        while not self.finished and self._count:
            offset = [t - x for t, x in zip(scene.targets[self._index], state.position, strict=True)]
            gap = math.hypot(*offset)
            if gap > self._settings.tolerance:
                break
            self._index += 1
        if self.finished or not self._count:
            return SteeringInput(engaged=False)
        scale = self._speed(gap) / gap
        velocity = (offset[0] * scale, offset[1] * scale, offset[2] * scale)
        return SteeringInput(velocity, engaged=True, acknowledge=self._acknowledges(state, now_ns))

    def _speed(self, gap: float) -> float:
        s = self._settings
        share = min(1.0, max(0.0, (gap - s.near) / (s.far - s.near)))
        return s.near_speed + share * (s.far_speed - s.near_speed)

    def _acknowledges(self, state: RobotState, now_ns: int) -> bool:
        """Twice a second while there is a need: an acknowledgement may get lost like any message."""
        if state.mode == "estop" or (state.mode != "stopped" and state.holder != 0):
            return False
        if self._acknowledged_ns is not None and now_ns - self._acknowledged_ns < ACKNOWLEDGE_PERIOD_NS:
            return False
        self._acknowledged_ns = now_ns
        return True
