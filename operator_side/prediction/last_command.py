"""The last command, held for one mean round trip."""

from farhand.common.messages.state import RobotState
from farhand.operator_side.prediction.law import Prediction, StatePredictor, moved


class LastCommand(StatePredictor):
    """The last command, held for one mean round trip."""

    def predict(self, state: RobotState, seq: int, now_ns: int, rtt_mean: float) -> Prediction:
        """See StatePredictor."""
        commands = self.known.history.newest_first()
        if not commands:
            return Prediction(state.position)
        return Prediction(moved(state.position, commands[0].velocity(0), rtt_mean), rtt_mean)
