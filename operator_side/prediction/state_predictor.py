"""Where the robot will be when the command that is being computed takes effect.

A reported state is old, and the commands under way will still move the robot. Each law answers with the
start state for the controller. `echo` and `timeline` predict z = x + lag * v, for which a robot that follows
velocity commands with a first-order lag obeys dz/dt = u exactly.
"""

import math
from dataclasses import dataclass
from typing import Protocol

from farhand.common.messages.base import Vector3
from farhand.common.messages.state import RobotState
from farhand.common.scenario import PredictorName
from farhand.operator_side.prediction.command_history import CommandHistory, SentCommand


@dataclass(frozen=True, slots=True)
class Prediction:
    """Attributes:
    start: where the plan begins (m).
    look: time from the state's sample to the instant at which the new command takes effect (s).
    spread: largest distance between `start` and where the robot may be if commands were lost (m).
    """

    start: Vector3
    look: float = 0.0
    spread: float = 0.0


class StatePredictor(Protocol):
    """A prediction law."""

    def predict(self, state: RobotState, seq: int, now_ns: int, rtt_mean: float) -> Prediction:
        """Predict the start state of command `seq`, computed now.

        Args:
            state: newest state of the robot.
            seq: sequence number of the command that is being computed.
            now_ns: beginning of the tick.
            rtt_mean: mean round trip over the window (s).
        """
        ...


def make_predictor(
    name: PredictorName, history: CommandHistory, session: int, period: float, lag: float
) -> StatePredictor:
    """The law with the given name.

    Args:
        name: which.
        history: the commands sent.
        session: this operator's session.
        period: of the operator's tick (s).
        lag: of the robot's velocity response (s).
    """
    match name:
        case "none":
            return NoPrediction()
        case "last-command":
            return LastCommand(history)
        case "history":
            return History(history)
        case "echo":
            return EchoPrediction(history, session, period, lag)
        case "timeline":
            return Timeline(history, session, period, lag)


def lag_compensated(state: RobotState, lag: float) -> Vector3:
    """z = x + lag * v of a state (m)."""
    (x, y, z), (u, v, w) = state.position, state.velocity
    return (x + lag * u, y + lag * v, z + lag * w)


class NoPrediction:
    """The robot is where it last said it was."""

    def predict(self, state: RobotState, seq: int, now_ns: int, rtt_mean: float) -> Prediction:
        """See StatePredictor."""
        return Prediction(state.position)


class LastCommand:
    """The last command, held for one mean round trip."""

    def __init__(self, history: CommandHistory) -> None:
        self._history = history

    def predict(self, state: RobotState, seq: int, now_ns: int, rtt_mean: float) -> Prediction:
        """See StatePredictor."""
        commands = self._history.newest_first()
        if not commands:
            return Prediction(state.position)
        return Prediction(_moved(state.position, commands[0].velocity(0), rtt_mean), rtt_mean)


class History:
    """The commands sent during the last mean round trip, integrated over it: the paper's way."""

    def __init__(self, history: CommandHistory) -> None:
        self._history = history

    def predict(self, state: RobotState, seq: int, now_ns: int, rtt_mean: float) -> Prediction:
        """See StatePredictor."""
        position, until = state.position, 0.0
        for command in self._history.newest_first():
            since = min((now_ns - command.t_sent_ns) * 1e-9, rtt_mean)
            if since > until:
                position = _moved(position, command.velocity(0), since - until)
                until = since
            if until >= rtt_mean:
                break
        return Prediction(position, rtt_mean)


class EchoPrediction:
    """The commands after the one that the robot says it applies, each for one period: no clock, no average.

    Command `seq` takes effect (seq - s) * period - hold after the sampled state.
    """

    def __init__(self, history: CommandHistory, session: int, period: float, lag: float) -> None:
        self._history, self._session, self._period, self._lag = history, session, period, lag

    def predict(self, state: RobotState, seq: int, now_ns: int, rtt_mean: float) -> Prediction:
        """See StatePredictor."""
        start = lag_compensated(state, self._lag)
        applied = _applied(state, self._session, self._history)
        if applied is None:
            return Prediction(start)
        held = state.applied_for_ns * 1e-9
        start = _moved(start, applied.velocity(0), max(0.0, self._period - held))
        for k in range(applied.seq + 1, seq):
            command = self._history.get(k)
            if command is not None:
                start = _moved(start, command.velocity(0), self._period)
        return Prediction(start, max(0.0, (seq - applied.seq) * self._period - held))


class Timeline:
    """The robot's whole timeline from its echo to the new command, with what it does when commands stay away.

    The state says: command s applied, held for h. In the j-th period after s took effect the robot runs
    command s + j; where that was never sent, or in the period j0 = floor(h / period) under way, it plays on
    the newest plan that it has. Commands that were due by then and are not echoed count as lost. `spread` is
    the largest difference that further losses could make.
    """

    def __init__(self, history: CommandHistory, session: int, period: float, lag: float) -> None:
        self._history, self._session, self._period, self._lag = history, session, period, lag

    def predict(self, state: RobotState, seq: int, now_ns: int, rtt_mean: float) -> Prediction:
        """See StatePredictor."""
        z = lag_compensated(state, self._lag)
        applied = _applied(state, self._session, self._history)
        if applied is None:
            return Prediction(z)
        period, held = self._period, state.applied_for_ns * 1e-9
        under_way, last = int(held / period), seq - applied.seq
        look = last * period - held
        if look <= 0.0:
            return Prediction(z)
        travelled, base = applied.displacement(last * period), applied.displacement(held)
        branches = [_sum(z, travelled, base)]
        playing = applied
        for j in range(under_way, last):
            command = self._history.get(applied.seq + j) if j > under_way else None
            if command is not None:
                playing = command
                branches.append(_sum(z, command.displacement((last - j) * period)))
            duration = period if j > under_way else (under_way + 1) * period - held
            z = _moved(z, playing.velocity(j - (playing.seq - applied.seq)), duration)
        spread = max(math.dist(branch, z) for branch in branches)
        return Prediction(z, look, spread)


class Innovations:
    """How far predictions were off: the robot's echo tells where a command really began.

    Args:
        history: the commands sent.
        session: this operator's session.
        lag: of the robot's velocity response (s).
        window: number of commands over which the maximum is taken.
    """

    def __init__(self, history: CommandHistory, session: int, lag: float, window: int) -> None:
        self._history, self._session, self._lag = history, session, lag
        self._window = window
        self._newest_seq = -1
        self._errors: list[float] = []
        self.newest = 0.0

    def observe(self, state: RobotState) -> None:
        """Compare the first state that shows a command applied with the prediction made for it."""
        applied = _applied(state, self._session, self._history)
        if applied is None or applied.seq <= self._newest_seq:
            return
        self._newest_seq = applied.seq
        z = lag_compensated(state, self._lag)
        began = _sum(z, (0.0, 0.0, 0.0), applied.displacement(state.applied_for_ns * 1e-9))
        self.newest = math.dist(began, applied.predicted)
        self._errors.append(self.newest)
        if len(self._errors) > self._window:
            self._errors.pop(0)

    @property
    def largest(self) -> float:
        """Largest error of the window (m)."""
        return max(self._errors, default=0.0)


def _applied(state: RobotState, session: int, history: CommandHistory) -> SentCommand | None:
    return history.get(state.applied_seq) if state.applied_session == session else None


def _moved(position: Vector3, velocity: Vector3, duration: float) -> Vector3:
    return (
        position[0] + velocity[0] * duration,
        position[1] + velocity[1] * duration,
        position[2] + velocity[2] * duration,
    )


def _sum(a: Vector3, plus: Vector3, minus: Vector3 = (0.0, 0.0, 0.0)) -> Vector3:
    return (a[0] + plus[0] - minus[0], a[1] + plus[1] - minus[1], a[2] + plus[2] - minus[2])
