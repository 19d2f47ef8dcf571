"""The paper's tester: heads straight for the next target and ignores every obstacle.

Speed 0.05 m/s within 0.15 m of the target, 0.50 m/s beyond 0.50 m, linear between (arXiv 2403.18650).
"""

import math
from typing import ClassVar

from farhand.common.messages.base import Positive
from farhand.common.messages.state import FAULT, RobotState
from farhand.common.scenario.section import Section
from farhand.operator_side.steering.device import SteeringDevice, SteeringInput, View

ACKNOWLEDGE_PERIOD_NS = 500_000_000
FAULT_TRIES = 3
FAULT_BACK_NS = 5_000_000_000
"""A fault within this time after an acknowledgement was not cleared by it."""
_GIVEN_UP = f"the tester acknowledges it no more: it came back {FAULT_TRIES} times; see to the robot"


class TesterSettings(Section, frozen=True, kw_only=True):
    """Attributes:
    near, far: distances between which the speed rises linearly (m).
    near_speed, far_speed: the speeds there (m/s).
    """

    near: Positive = 0.15
    far: Positive = 0.50
    near_speed: Positive = 0.05
    far_speed: Positive = 0.50

    def __post_init__(self) -> None:
        """Raises ValueError where the distances are not in order, which reading turns into a message."""
        if self.far <= self.near:
            raise ValueError(f"far, {self.far:g} m, must be larger than near, {self.near:g} m")


class Tester(SteeringDevice):
    """Drives through the scene's targets in order; acknowledges a latched stop and control that
    has become free, as a person would, but never an emergency stop, nor a fault that came back FAULT_TRIES times.
    """

    Settings: ClassVar[type[Section]] = TesterSettings
    acknowledges_itself: ClassVar[bool] = True

    def __init__(self, settings: TesterSettings) -> None:
        super().__init__(settings)
        self._speeds = settings
        self._acknowledged_ns: int | None = None
        self._fault_stops = 0  # of the robot, when its fault was acknowledged last
        self._fault_ns: int | None = None  # when that was
        self._came_back = 0

    def read(self, view: View) -> SteeringInput:
        """Straight towards the next target, from where the robot last said it was."""
        target, state = view.targets.next, view.state
        if target is None:
            return SteeringInput(engaged=False)
        offset = [t - x for t, x in zip(target, state.position, strict=True)]
        gap = math.hypot(*offset)
        scale = self._speed(gap) / gap
        velocity = (offset[0] * scale, offset[1] * scale, offset[2] * scale)
        if self._is_given_up(state, view.now_ns):
            return SteeringInput(velocity, engaged=True, says=_GIVEN_UP)
        return SteeringInput(velocity, engaged=True, acknowledge=self._acknowledges(state, view.now_ns))

    def _speed(self, gap: float) -> float:
        s = self._speeds
        share = min(1.0, max(0.0, (gap - s.near) / (s.far - s.near)))
        return s.near_speed + share * (s.far_speed - s.near_speed)

    def _acknowledges(self, state: RobotState, now_ns: int) -> bool:
        """Twice a second while there is a need: an acknowledgement may get lost like any message."""
        if state.mode == "estop" or (state.mode != "stopped" and state.holder != 0):
            return False
        if self._acknowledged_ns is not None and now_ns - self._acknowledged_ns < ACKNOWLEDGE_PERIOD_NS:
            return False
        self._acknowledged_ns = now_ns
        if _is_fault(state):
            self._fault_stops, self._fault_ns = state.stops, now_ns
        return True

    def _is_given_up(self, state: RobotState, now_ns: int) -> bool:
        """Whether the robot is in a fault that no acknowledgement clears; counts how often it came back."""
        if not _is_fault(state):
            return False
        if self._fault_ns is not None and state.stops != self._fault_stops:
            is_back = now_ns - self._fault_ns <= FAULT_BACK_NS
            self._came_back = self._came_back + 1 if is_back else 0
            self._fault_stops = state.stops
        return self._came_back >= FAULT_TRIES


def _is_fault(state: RobotState) -> bool:
    return state.mode == "stopped" and state.reason.startswith(FAULT)
