"""The last command, held for one mean round trip."""

from farhand.common.messages.state import RobotState
from farhand.operator_side.prediction.law import Prediction, StatePredictor, moved, turning_for


class LastCommand(StatePredictor):
    """The last command, held for one mean round trip."""

    def predict(self, state: RobotState, seq: int, now_ns: int, rtt_mean: float) -> Prediction:
        """See StatePredictor."""
        commands = self.known.history.newest_first()
        if not commands:
            return Prediction(state.position)
        last = commands[0]
        return Prediction(
            moved(state.position, last.velocity(0), rtt_mean),
            rtt_mean,
            orientation=turning_for(state.orientation, last.turning(0), rtt_mean),
        )
