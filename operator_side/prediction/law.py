"""The interface of every prediction law: where the robot will be when the command that is being computed takes effect.

A reported state is old, and the commands under way will still move the robot. Each law answers with the start
state for the controller.
"""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

from farhand.common.geometry import turned
from farhand.common.messages.base import ZERO, Quaternion, Vector3
from farhand.common.messages.state import RobotState
from farhand.operator_side.prediction.command_history import CommandHistory, SentCommand


@dataclass(frozen=True, slots=True)
class Prediction:
    """Attributes:
    start: where the plan begins (m).
    look: time from the state's sample to the instant at which the new command takes effect (s).
    spread: largest distance between `start` and where the robot may be if commands were lost (m).
    velocity: of the body there (m/s), where the law knows; None: as last reported.
    orientation: of the tool there (w, x, y, z), where the law knows; None: as last reported. For people, who see the
        tool where it will be: nothing is decided by it.
    """

    start: Vector3
    look: float = 0.0
    spread: float = 0.0
    velocity: Vector3 | None = None
    orientation: Quaternion | None = None


@dataclass(frozen=True, slots=True)
class Known:
    """What a prediction law may know.

    Attributes:
        history: the commands sent.
        session: this operator's session.
        period: of the operator's tick (s); a plan's own may be a multiple, see SentCommand.
        lag: of the robot's velocity response, as the robot says (s).
    """

    history: CommandHistory
    session: int
    period: float
    lag: float

    def applied(self, state: RobotState) -> SentCommand | None:
        """The command that the robot says it applies; None if it is not this session's, or was forgotten."""
        return self.history.get(state.applied_seq) if state.applied_session == self.session else None

    def compensated(self, state: RobotState) -> Vector3:
        """z = x + lag * v of a state (m): for a robot that follows velocity commands with a first-order lag,
        dz/dt = u exactly."""
        (x, y, z), (u, v, w), lag = state.position, state.velocity, self.lag
        return (x + lag * u, y + lag * v, z + lag * w)

    def turned_on(self, state: RobotState) -> Quaternion:
        """The orientation after lag * w, as z is for the position: from there on it turns as commanded."""
        return turning_for(state.orientation, state.angular_velocity, self.lag)

    def followed(self, body: Vector3, velocity: Vector3, duration: float) -> Vector3:
        """The body's velocity after `duration` s at a commanded velocity, which it follows with its lag (m/s)."""
        kept = math.exp(-duration / self.lag) if self.lag > 0.0 else 0.0
        (u, v, w), (x, y, z) = velocity, body
        return (u + kept * (x - u), v + kept * (y - v), w + kept * (z - w))


class StatePredictor(ABC):
    """A prediction law. One small file, and one line in registry.py or an entry point in `farhand.predictors`.

    Args:
        known: what it may know.

    Attributes:
        knows_plan: whether it counts on the robot playing out the plan behind a velocity; else every entry of
            the plan that is sent is the velocity itself.
        compensates_lag: whether `start` is z = x + lag v and not the body's own position; what the body then
            cuts from z's corners is added to every margin (operator_side/margins/lag.py).
    """

    knows_plan: ClassVar[bool] = False
    compensates_lag: ClassVar[bool] = False

    def __init__(self, known: Known) -> None:
        self.known = known

    @abstractmethod
    def predict(self, state: RobotState, seq: int, now_ns: int, rtt_mean: float) -> Prediction:
        """Predict the start state of command `seq`, computed now; must not raise.

        Args:
            state: newest state of the robot.
            seq: sequence number of the command that is being computed.
            now_ns: beginning of the tick.
            rtt_mean: mean round trip over the window (s).
        """


def turning_for(orientation: Quaternion, angular: Vector3, duration: float) -> Quaternion:
    """An orientation after `duration` s at an angular velocity (rad/s, base)."""
    if angular == ZERO:
        return orientation
    x, y, z = angular
    return turned(orientation, (x * duration, y * duration, z * duration))


def moved(position: Vector3, velocity: Vector3, duration: float) -> Vector3:
    """Where a point at `position` (m) is after `duration` s at `velocity` (m/s)."""
    return (
        position[0] + velocity[0] * duration,
        position[1] + velocity[1] * duration,
        position[2] + velocity[2] * duration,
    )


def shifted(a: Vector3, plus: Vector3, minus: Vector3 = (0.0, 0.0, 0.0)) -> Vector3:
    """A + plus - minus."""
    return (a[0] + plus[0] - minus[0], a[1] + plus[1] - minus[1], a[2] + plus[2] - minus[2])
