"""Predictor feedback for a delay that is known and constant: what was commanded during it, integrated over it.

x(t + tau) = x(t) + integral of u over [t - tau, t], on which a barrier is then imposed as if there were no delay:
M. Jankovic, "Control barrier functions for constrained control of linear systems with input delay", ACC 2018; T. G.
Molnar, A. K. Kiss, A. D. Ames, G. Orosz, "Safety-critical control with input delay in dynamic environment", IEEE Trans.
Control Systems Technology 31(4), 2023. The robot's lag is part of the known system: z = x + lag v obeys dz/dt = u.
"""

from farhand.common.messages.state import RobotState
from farhand.operator_side.prediction.law import Known, Prediction, StatePredictor, moved, turning_for

IDENTIFIED = 30
"""Ticks with a measured round trip, after which its mean is the known delay for good: the paper's window."""


class KnownDelay(StatePredictor):
    """The delay is the mean round trip of the first IDENTIFIED ticks, and is held for constant from there on."""

    compensates_lag = True

    def __init__(self, known: Known) -> None:
        super().__init__(known)
        self._delay, self._ticks = 0.0, 0

    def predict(self, state: RobotState, seq: int, now_ns: int, rtt_mean: float) -> Prediction:
        """See StatePredictor."""
        if self._ticks < IDENTIFIED and rtt_mean > 0.0:
            self._ticks += 1
            self._delay = rtt_mean
        z, orientation, until = self.known.compensated(state), self.known.turned_on(state), 0.0
        for command in self.known.history.newest_first():
            since = min((now_ns - command.t_sent_ns) * 1e-9, self._delay)
            if since > until:
                z = moved(z, command.velocity(0), since - until)
                orientation = turning_for(orientation, command.turning(0), since - until)
                until = since
            if until >= self._delay:
                break
        return Prediction(z, self._delay, orientation=orientation)
