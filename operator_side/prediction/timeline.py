"""The robot's whole timeline from its echo to the new command, with what it does when commands stay away."""

import math

from farhand.common.messages.state import RobotState
from farhand.operator_side.prediction.law import Prediction, StatePredictor, moved, shifted, turning_for


class Timeline(StatePredictor):
    """The state says: command s applied, held for h.

    In the j-th tick after s took effect the robot runs command s + j; where that was never sent, or in the
    tick j0 = floor(h / period) under way, it plays on the newest plan that it has, of which a step is a whole
    number of ticks. Commands that were due by then and are not echoed count as lost. `spread` is the largest
    difference that further losses could make.
    """

    knows_plan = True
    compensates_lag = True

    def predict(self, state: RobotState, seq: int, now_ns: int, rtt_mean: float) -> Prediction:
        """See StatePredictor."""
        known = self.known
        z, orientation = known.compensated(state), known.turned_on(state)
        applied = known.applied(state)
        if applied is None:
            return Prediction(z, orientation=orientation)
        period, held = known.period, state.applied_for_ns * 1e-9
        under_way, last = int(held / period), seq - applied.seq
        look = last * period - held
        if look <= 0.0:
            return Prediction(z, orientation=orientation)
        travelled, base = applied.displacement(last * period), applied.displacement(held)
        branches = [shifted(z, travelled, base)]
        playing, body = applied, state.velocity
        for j in range(under_way, last):
            command = known.history.get(applied.seq + j) if j > under_way else None
            if command is not None:
                playing = command
                branches.append(shifted(z, command.displacement((last - j) * period)))
            duration = period if j > under_way else (under_way + 1) * period - held
            entry = (j - (playing.seq - applied.seq)) // round(playing.period / period)
            velocity = playing.velocity(entry)
            z, body = moved(z, velocity, duration), known.followed(body, velocity, duration)
            orientation = turning_for(orientation, playing.turning(entry), duration)
        spread = max(math.dist(branch, z) for branch in branches)
        return Prediction(z, look, spread, body, orientation)
