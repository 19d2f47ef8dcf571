"""The robot is where it last said it was."""

from farhand.common.messages.state import RobotState
from farhand.operator_side.prediction.law import Prediction, StatePredictor


class NoPrediction(StatePredictor):
    """The robot is where it last said it was."""

    def predict(self, state: RobotState, seq: int, now_ns: int, rtt_mean: float) -> Prediction:
        """See StatePredictor."""
        return Prediction(state.position)
