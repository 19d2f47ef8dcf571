"""The commands after the one that the robot says it applies, each for one period: no clock, no average."""

from farhand.common.messages.state import RobotState
from farhand.operator_side.prediction.law import Prediction, StatePredictor, moved, turning_for


class EchoPrediction(StatePredictor):
    """Command `seq` takes effect (seq - s) * period - hold after the sampled state, s the command applied there."""

    knows_plan = True
    compensates_lag = True

    def predict(self, state: RobotState, seq: int, now_ns: int, rtt_mean: float) -> Prediction:
        """See StatePredictor."""
        known = self.known
        start, orientation = known.compensated(state), known.turned_on(state)
        applied = known.applied(state)
        if applied is None:
            return Prediction(start, orientation=orientation)
        period, held = known.period, state.applied_for_ns * 1e-9
        rest, body = max(0.0, period - held), state.velocity
        start, body = moved(start, applied.velocity(0), rest), known.followed(body, applied.velocity(0), rest)
        orientation = turning_for(orientation, applied.turning(0), rest)
        for k in range(applied.seq + 1, seq):
            command = known.history.get(k)
            if command is not None:
                velocity = command.velocity(0)
                start, body = moved(start, velocity, period), known.followed(body, velocity, period)
                orientation = turning_for(orientation, command.turning(0), period)
        look = max(0.0, (seq - applied.seq) * period - held)
        return Prediction(start, look, velocity=body, orientation=orientation)
