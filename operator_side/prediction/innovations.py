"""How far predictions were off: the robot's echo tells where a command really began."""

import math
from collections import deque

from farhand.common.messages.state import RobotState
from farhand.operator_side.prediction.law import Known, shifted


class Innovations:
    """Prediction errors of the last commands.

    Args:
        known: the commands sent and the robot's lag.
        window: number of commands over which the maximum is taken.

    Attributes:
        newest: the newest error (m).
    """

    def __init__(self, known: Known, window: int) -> None:
        self._known = known
        self._newest_seq = -1
        self._errors: deque[float] = deque(maxlen=window)
        self.newest = 0.0

    def observe(self, state: RobotState) -> None:
        """Compare the first state that shows a command applied with the prediction made for it."""
        applied = self._known.applied(state)
        if applied is None or applied.seq <= self._newest_seq:
            return
        self._newest_seq = applied.seq
        z = self._known.compensated(state)
        began = shifted(z, (0.0, 0.0, 0.0), applied.displacement(state.applied_for_ns * 1e-9))
        self.newest = math.dist(began, applied.predicted)
        self._errors.append(self.newest)

    @property
    def largest(self) -> float:
        """Largest error of the window (m)."""
        return max(self._errors, default=0.0)
