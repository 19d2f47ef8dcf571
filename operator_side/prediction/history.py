"""The commands sent during the last mean round trip, integrated over it: the paper's way (arXiv 2403.18650)."""

from farhand.common.messages.state import RobotState
from farhand.operator_side.prediction.law import Prediction, StatePredictor, moved, turning_for


class History(StatePredictor):
    """The commands sent during the last mean round trip, integrated over it."""

    def predict(self, state: RobotState, seq: int, now_ns: int, rtt_mean: float) -> Prediction:
        """See StatePredictor."""
        position, orientation, until = state.position, state.orientation, 0.0
        for command in self.known.history.newest_first():
            since = min((now_ns - command.t_sent_ns) * 1e-9, rtt_mean)
            if since > until:
                position = moved(position, command.velocity(0), since - until)
                orientation = turning_for(orientation, command.turning(0), since - until)
                until = since
            if until >= rtt_mean:
                break
        return Prediction(position, rtt_mean, orientation=orientation)
