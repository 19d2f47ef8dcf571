"""The paper's tester: heads straight for the next target and ignores every obstacle.

Speed 0.05 m/s within 0.15 m of the target, 0.50 m/s beyond 0.50 m, linear between (arXiv 2403.18650). What the paper
does not have is off unless it is asked for: orientations to turn to on the way, and a step to the side where the
way straight on is blocked.
"""

import math
from typing import ClassVar

from farhand.common.geometry import norm, turn_between
from farhand.common.messages.base import ZERO, Positive, Quaternion, Vector3
from farhand.common.messages.state import FAULT, RobotState
from farhand.common.scenario.section import Section
from farhand.operator_side.steering.device import SteeringDevice, SteeringInput, View
from farhand.operator_side.steering.tester.sidestep import Instant, Sidestep

ACKNOWLEDGE_PERIOD_NS = 500_000_000
FAULT_TRIES = 3
FAULT_BACK_NS = 5_000_000_000
"""A fault within this time after an acknowledgement was not cleared by it."""
_GIVEN_UP = f"the tester acknowledges it no more: it came back {FAULT_TRIES} times; see to the robot"
SOFT = 0.2
"""The last part of a turn (rad), in which it slows down: what is commanded arrives late."""
TURNED = 0.05
"""Nearer than this to the wanted orientation (rad) the tool counts as turned."""
SLOWEST = 0.01
"""It does not stand and wait (m/s): an arm may not be able to turn any further."""
UNIT = 1e-3
"""A quaternion's length may be off by this."""


class TesterSettings(Section, frozen=True, kw_only=True):
    """Attributes:
    near, far: distances between which the speed rises linearly (m).
    near_speed, far_speed: the speeds there (m/s).
    orientations: of the tool in base, unit quaternions (w, x, y, z): the k-th target is reached with the k-th, those
        after the last one with the last; empty: the tool is not turned.
    turn_speed: angular speed of a turn (rad/s).
    sidestep: step to the side where the way straight on is blocked (sidestep.py).
    """

    near: Positive = 0.15
    far: Positive = 0.50
    near_speed: Positive = 0.05
    far_speed: Positive = 0.50
    orientations: tuple[Quaternion, ...] = ()
    turn_speed: Positive = 0.5
    sidestep: bool = False

    def __post_init__(self) -> None:
        """Raises ValueError where the distances are not in order, which reading turns into a message."""
        if self.far <= self.near:
            raise ValueError(f"far, {self.far:g} m, must be larger than near, {self.near:g} m")
        for index, quaternion in enumerate(self.orientations):
            length = norm(quaternion)
            if abs(length - 1.0) > UNIT:
                raise ValueError(
                    f"orientations[{index}] has length {length:.4g}; a unit quaternion (w, x, y, z) has 1"
                )


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
        self._sidestep = Sidestep() if settings.sidestep else None

    def read(self, view: View) -> SteeringInput:
        """Straight towards the next target, from where the robot last said it was."""
        target, state = view.targets.next, view.state
        if target is None:
            return SteeringInput(engaged=False)
        offset = [t - x for t, x in zip(target, state.position, strict=True)]
        gap = math.hypot(*offset)
        speed, angular = self._speed(gap), ZERO
        if self._speeds.orientations:
            away = turn_between(state.orientation, self._wanted_orientation(view.targets.reached))
            angular = self._angular(away)
            # Not there before it is turned: what is left of the way takes as long as what is left of the turn.
            speed = min(speed, max(SLOWEST, gap * self._speeds.turn_speed / max(norm(away), TURNED)))
        # A robot may stand on its target to the last bit: one that was restarted stands where it began.
        scale = speed / gap if gap > 0.0 else 0.0
        velocity = (offset[0] * scale, offset[1] * scale, offset[2] * scale)
        if self._sidestep is not None:
            instant = Instant(view.now_ns, state.position, state.velocity, view.free)
            velocity = self._sidestep.turn(velocity, instant)
        if self._is_given_up(state, view.now_ns):
            return SteeringInput(velocity, engaged=True, says=_GIVEN_UP, angular=angular)
        acknowledge = self._acknowledges(state, view.now_ns)
        return SteeringInput(velocity, engaged=True, acknowledge=acknowledge, angular=angular)

    def _wanted_orientation(self, reached: int) -> Quaternion:
        orientations = self._speeds.orientations
        w, x, y, z = orientations[min(reached, len(orientations) - 1)]
        return (w, x, y, z)

    def _angular(self, away: Vector3) -> Vector3:
        """Straight to the wanted orientation, ever slower within the last SOFT (rad/s)."""
        angle = norm(away)
        if angle == 0.0:
            return ZERO
        x, y, z = away
        scale = self._speeds.turn_speed * min(1.0, angle / SOFT) / angle
        return (x * scale, y * scale, z * scale)

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
