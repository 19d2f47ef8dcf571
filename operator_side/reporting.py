"""Writes the report of a tick: the one message that live status, console and recorder read."""

from farhand.common.messages.base import Vector3
from farhand.common.messages.command import CommandMode
from farhand.common.messages.report import ControlReport
from farhand.operator_side.margins.margin import Margin
from farhand.operator_side.perception import Perception
from farhand.operator_side.prediction.state_predictor import Prediction
from farhand.operator_side.round_trip import RoundTrip
from farhand.operator_side.safety_filter import Filtered


class ReportWriter:
    """Args:
    operator, session: this operator's name and session.
    perception, round_trip: what to report from.
    """

    def __init__(self, operator: str, session: int, perception: Perception, round_trip: RoundTrip) -> None:
        self._operator, self._session = operator, session
        self._perception, self._round_trip = perception, round_trip
        self._tick = -1

    def write(
        self,
        now_ns: int,
        *,
        seq: int,
        mode: CommandMode,
        reason: str,
        desired: Vector3,
        velocity: Vector3,
        prediction: Prediction,
        prediction_error: float,
        margin: Margin,
        filtered: Filtered | None,
        solve_time: float,
        progress: tuple[int, int],
        overruns: int,
    ) -> ControlReport:
        """The report of one tick; see ControlReport for the fields."""
        self._tick += 1
        state, trip = self._perception.state, self._round_trip
        seen = state is not None
        known = trip.count > 0
        state_age = (now_ns - self._perception.newest_state.arrived_ns) * 1e-9 if seen else 0.0
        return ControlReport(
            source=self._operator,
            session=self._session,
            seq=seq,
            t_sent_ns=now_ns,
            tick=self._tick,
            mode=mode,
            desired=desired,
            filtered=velocity,
            intervening=filtered is not None and (bool(filtered.binding) or bool(filtered.reason)),
            position=state.position if state else (0.0, 0.0, 0.0),
            predicted=prediction.start,
            prediction_error=prediction_error,
            sigma=margin.sigma,
            inflation=margin.inflation,
            margin_parts=margin.parts,
            rtt=trip.newest,
            rtt_mean=trip.mean if known else None,
            rtt_std=trip.std if known else None,
            loss=trip.loss,
            age=max(0.0, trip.age(now_ns)),
            state_age=max(0.0, state_age),
            status=filtered.solution.status.value if filtered else "idle",
            solve_time=solve_time,
            binding=filtered.binding if filtered else "",
            clearance=state.clearance if state else None,
            min_clearance=state.min_clearance if state else None,
            safety=state.mode if state else None,
            safety_reason=state.reason if state else "",
            stop_reason=reason[:512],
            target_index=progress[0],
            target_count=progress[1],
            refused_here=self._perception.refused,
            refused_there=sum(state.refused.values()) if state else 0,
            stops=state.stops if state else 0,
            state_rate=self._perception.state_rate(now_ns),
            states=self._perception.states,
            overruns=overruns,
        )
