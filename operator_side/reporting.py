"""Writes the report of a tick: the one message that live status, console and recorder read."""

import msgspec

from farhand.common.geometry import Twist
from farhand.common.messages.command import CommandMode
from farhand.common.messages.report import UPRIGHT, ControlReport
from farhand.operator_side.margins.law import Margin
from farhand.operator_side.prediction.law import Prediction
from farhand.operator_side.safety_filter import Filtered
from farhand.operator_side.sensing.blockage import Blocked
from farhand.operator_side.sensing.perception import Perception
from farhand.operator_side.sensing.round_trip import RoundTrip
from farhand.operator_side.sensing.standstill import Attempt, Standstill
from farhand.operator_side.steering.targets import Targets


class Tick(msgspec.Struct, frozen=True, kw_only=True):
    """What was decided in one tick; see ControlReport for what is not said here.

    Attributes:
        now_ns: its beginning.
        reason: why the operator side commands zero, or empty.
        desired: before filtering.
        sent: what is sent.
        prediction_error: newest innovation (m).
        filtered: the filter's answer; None where it was not asked.
        solve_time: (s).
        blocked: what stands in the way that is wanted.
    """

    now_ns: int
    seq: int
    mode: CommandMode
    reason: str
    desired: Twist
    sent: Twist
    prediction: Prediction
    prediction_error: float
    margin: Margin
    filtered: Filtered | None
    solve_time: float
    overruns: int
    blocked: Blocked


class ReportWriter:
    """Args:
    operator, session: this operator's name and session.
    perception, round_trip: what to report from.
    """

    def __init__(self, operator: str, session: int, perception: Perception, round_trip: RoundTrip) -> None:
        self._operator, self._session = operator, session
        self._perception, self._round_trip = perception, round_trip
        self._tick = -1
        self._standstill = Standstill()

    def write(self, tick: Tick, targets: Targets) -> ControlReport:
        """The report of one tick; see ControlReport for the fields."""
        self._tick += 1
        now_ns, margin, filtered = tick.now_ns, tick.margin, tick.filtered
        state, trip = self._perception.state, self._round_trip
        known = trip.count > 0
        lag_part = filtered.lag_part if filtered is not None else 0.0
        state_age = 0.0
        if state is not None:
            state_age = (now_ns - self._perception.newest_state.arrived_ns) * 1e-9 + state.sample_age
        guard = self._perception.take_guard()
        attempt = Attempt(
            now_ns,
            tick.mode,
            tick.reason,
            tick.desired.linear,
            tick.sent.linear,
            tick.blocked.obstacle or (filtered.binding if filtered else ""),
            tick.blocked.side,
            f"{guard.part} off {guard.obstacle!r}" if guard is not None else "",
        )
        orientation = state.orientation if state else UPRIGHT
        held_by = self._standstill.step(attempt, state, round(state_age * 1e9))
        return ControlReport(
            source=self._operator,
            session=self._session,
            seq=tick.seq,
            t_sent_ns=now_ns,
            tick=self._tick,
            mode=tick.mode,
            desired=tick.desired.linear,
            filtered=tick.sent.linear,
            desired_angular=tick.desired.angular,
            angular=tick.sent.angular,
            intervening=filtered is not None and (bool(filtered.binding) or bool(filtered.reason)),
            position=state.position if state else (0.0, 0.0, 0.0),
            orientation=orientation,
            predicted=tick.prediction.start,
            predicted_orientation=tick.prediction.orientation or orientation,
            prediction_error=tick.prediction_error,
            sigma=margin.sigma,
            inflation=margin.inflation + lag_part,
            margin_parts=margin.parts | ({"lag": lag_part} if lag_part else {}),
            rtt=trip.newest,
            rtt_mean=trip.mean if known else None,
            rtt_std=trip.std if known else None,
            loss=trip.loss,
            age=max(0.0, trip.age(now_ns)),
            state_age=max(0.0, state_age),
            status=filtered.solution.status.value if filtered else "idle",
            solve_time=tick.solve_time,
            binding=filtered.binding if filtered else "",
            clearance=state.clearance if state else None,
            min_clearance=state.min_clearance if state else None,
            safety=state.mode if state else None,
            safety_reason=state.reason if state else "",
            stop_reason=tick.reason[:512],
            target_index=targets.reached,
            target_count=targets.count,
            refused_here=self._perception.refused,
            refused_there=sum(state.refused.values()) if state else 0,
            stops=state.stops if state else 0,
            state_rate=self._perception.state_rate(now_ns),
            states=self._perception.states,
            overruns=tick.overruns,
            held_by=held_by[:512],
            blocked_by=tick.blocked.obstacle,
            free_side=tick.blocked.side,
            guard=guard,
        )
