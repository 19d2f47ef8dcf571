"""The operator's side, once a tick:

link -> perception (newest state, scene, description) -> round trip, innovations
     -> targets reached -> steering device (desired velocity) -> supervision (mode)
     -> state predictor (where the robot will be) -> margin -> safety filter (MPC-CBF)
     -> velocity command with its plan -> link,  and a report of it all.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Protocol

from farhand.common.geometry import norm, to_vector3
from farhand.common.link.link import Link, Packet
from farhand.common.messages.base import ZERO, Vector3
from farhand.common.messages.codec import encode
from farhand.common.messages.command import CommandMode, VelocityCommand
from farhand.common.messages.description import RobotDescription
from farhand.common.messages.keys import command_key
from farhand.common.messages.report import ControlReport
from farhand.common.messages.scene import Scene
from farhand.common.messages.state import RobotState
from farhand.common.timing.clock import to_ns
from farhand.common.timing.periodic import Periodic
from farhand.operator_side.control.controller import Controller
from farhand.operator_side.delay_limits import beyond_limits
from farhand.operator_side.faults import checked_margin, checked_plan, checked_steering, told
from farhand.operator_side.margins.law import Margin, MarginInput
from farhand.operator_side.margins.registry import make_margin
from farhand.operator_side.perception import Perception
from farhand.operator_side.prediction.command_history import CommandHistory
from farhand.operator_side.prediction.innovations import Innovations
from farhand.operator_side.prediction.law import Known, Prediction, StatePredictor
from farhand.operator_side.prediction.registry import PREDICTORS
from farhand.operator_side.reporting import ReportWriter, Tick
from farhand.operator_side.round_trip import RoundTrip
from farhand.operator_side.safety_filter import Ahead, Filtered, SafetyFilter
from farhand.operator_side.settings import OperatorScenario
from farhand.operator_side.steering.device import SteeringDevice, View
from farhand.operator_side.steering.targets import Targets
from farhand.operator_side.supervision import Decision, Supervision

STALE_STATE = "no news from the robot: resynchronising"


class Recorder(Protocol):
    """Takes what reached the node and what it decided, tick by tick."""

    def tick(self, now_ns: int, packets: list[Packet], command: bytes | None, report: ControlReport) -> None:
        """One tick; must not block."""
        ...


@dataclass(frozen=True, slots=True)
class OperatorIdentity:
    """Who steers which robot.

    Attributes:
        robot: the robot's name.
        session: this start of the operator's program.
        name: the operator's own, which all others are told.
    """

    robot: str
    session: int
    name: str = "operator"


@dataclass(frozen=True, slots=True)
class _Mind:
    """What depends on the robot.

    Attributes:
        robot: as it describes itself.
        innovations: errors of the predictions so far.
        predictor: where it will be.
        filter: what it may do.
    """

    robot: RobotDescription
    innovations: Innovations
    predictor: StatePredictor
    filter: SafetyFilter


@dataclass(frozen=True, slots=True)
class _Decided:
    """What a tick shall command; see reporting.Tick for what is not said here."""

    decision: Decision
    reason: str
    desired: Vector3
    prediction: Prediction = field(default_factory=lambda: Prediction(ZERO))
    margin: Margin = field(default_factory=Margin)
    filtered: Filtered | None = None
    solve_time: float = 0.0


class OperatorNode:
    """See the module's docstring.

    Args:
        scenario: settings; obstacles and targets come over the wire instead.
        controller: the safety filter, prepared.
        device: what steers.
        link: to the robot.
        who: steers which robot.
        stopwatch: reads seconds, to report how long a solve took; None reports 0 (virtual time).
    """

    def __init__(
        self,
        scenario: OperatorScenario,
        controller: Controller,
        device: SteeringDevice,
        link: Link,
        who: OperatorIdentity,
        stopwatch: Callable[[], float] | None = None,
    ) -> None:
        self.scenario, self.device, self.who, self.session = scenario, device, who, who.session
        self.report: ControlReport | None = None
        self.listeners: list[Callable[[ControlReport], object]] = []  # told of every tick; must be quick
        self.recorder: Recorder | None = None
        self._link, self._key = link, command_key(who.robot)
        self._stopwatch = stopwatch
        self._ticks = Periodic(to_ns(scenario.controller.period))
        self._period = scenario.controller.period
        self._perception = Perception(who.robot)
        self.round_trip = RoundTrip(who.session, scenario.margin.rtt_window)
        self._history = CommandHistory()
        self._margin = make_margin(scenario.margin)
        self._controller = controller
        predictor = scenario.operator.predictor or self._margin.predictor
        self._prediction_law = PREDICTORS.get(predictor, "operator.predictor")
        self._mind: _Mind | None = None
        self._targets = Targets(scenario.operator.tolerance)
        self._supervision = Supervision(who.session, who.name)
        self._writer = ReportWriter(who.name, who.session, self._perception, self.round_trip)
        self._seq, self._refused_after = -1, 0.0  # s from the first command to news of stale ones
        self.fault = ""  # what a kind got wrong, in one line: the node stands from then on
        self.driving_since_ns: int | None = None  # instant of the first `run` command

    @property
    def finished(self) -> bool:
        """Whether every target has been reached."""
        return self._targets.finished

    @property
    def waits(self) -> bool:
        """Whether another session holds control."""
        state = self._perception.state
        return state is not None and state.holder not in (0, self.session)

    @property
    def state(self) -> RobotState | None:
        """The robot's newest state."""
        return self._perception.state

    @property
    def robot(self) -> RobotDescription | None:
        """What the robot says it is; None before it has."""
        return self._perception.description

    @property
    def scene(self) -> Scene | None:
        """What the robot says is around it, as it came last."""
        return self._perception.scene

    @property
    def successor(self) -> int:
        """The session that control is being handed over to; 0 once that is done, or it waits no more."""
        return self._supervision.successor

    def hand_over(self, successor: int) -> None:
        """Give control to a session that waits for it, from the next tick on until the robot says so."""
        self._supervision.successor = successor

    def emergency_stop(self) -> None:
        """Send emergency stops from the next tick on until the robot says that it has latched one."""
        self._supervision.estop = True

    @property
    def stopping(self) -> bool:
        """Whether an emergency stop that was asked for is not confirmed yet."""
        return self._supervision.estop

    def acknowledge(self) -> None:
        """Acknowledge the stop that the newest state shows, from the next tick on until the robot has left it."""
        state = self._perception.state
        if state is not None:
            self._supervision.clear(state)

    @property
    def clearing(self) -> bool:
        """Whether a stop that was to be acknowledged is not over yet."""
        return self._supervision.clearing is not None

    def step(self, now_ns: int) -> int:
        """One tick if it is due; returns the instant of the next."""
        periods = self._ticks.due(now_ns)
        if periods:
            # Missed ticks use up sequence numbers: seq counts periods, which the timeline relies on.
            self._seq += periods
            self._tick(now_ns)
        assert self._ticks.next_ns is not None
        return self._ticks.next_ns

    def correct(self, command: VelocityCommand) -> None:
        """Note what really was sent with the newest sequence number: a replay of another controller's run
        must predict from the commands that the robot got."""
        decided = self._history.get(command.seq)
        if decided is not None:
            velocities = (command.velocity, *command.plan)
            self._history.add(command.seq, decided.t_sent_ns, self._period, velocities, decided.predicted)

    def release(self, now_ns: int) -> None:
        """Give control up; the last command of a session."""
        self._seq += 1
        self._send(now_ns, "release", ZERO, (), ZERO)

    def _tick(self, now_ns: int) -> None:
        packets = self._link.receive()
        for packet in packets:
            self._take(packet)
        try:
            decided = self._stand() if self.fault else self._decide(now_ns)
        except Exception as error:  # of a law, a device or a controller: nothing throws in a control loop
            self.fault = told(error)
            decided = self._stand()
        decision, prediction, filtered = decided.decision, decided.prediction, decided.filtered
        mode, mind = decision.mode, self._mind
        desired = decided.desired
        velocities = self._velocities(filtered)
        payload = None
        if mode is not None:
            if not decision.asking:
                self._history.add(self._seq, now_ns, self._period, velocities, prediction.start)
                self.round_trip.sent(self._seq, now_ns)
            payload = self._send(now_ns, mode, velocities[0], velocities[1:], desired, decision.successor)
        self.report = self._writer.write(
            Tick(
                now_ns=now_ns,
                seq=self._seq,
                mode=mode or "hold",
                reason=decided.reason,
                desired=desired,
                velocity=velocities[0],
                prediction=prediction,
                prediction_error=mind.innovations.newest if mind is not None else 0.0,
                margin=decided.margin,
                filtered=filtered,
                solve_time=decided.solve_time,
                overruns=self._ticks.overruns,
            ),
            self._targets,
        )
        if self.recorder is not None:
            self.recorder.tick(now_ns, packets, payload, self.report)
        for listener in self.listeners:
            listener(self.report)

    def _decide(self, now_ns: int) -> "_Decided":
        """What this tick shall command; raises whatever a kind raises."""
        state, scene = self._perception.state, self._perception.scene
        mind = self._know_the_robot()
        steering = None
        if state is not None and scene is not None and mind is not None:
            self._targets.update(state, scene, driving=state.holder == self.session)
            steering = checked_steering(self.device.read(View(state, scene, self._targets, now_ns)))
        self._supervision.twins = self._perception.twins(now_ns)
        decision = self._supervision.step(state, self._perception.lacking, steering, now_ns)
        decided = _Decided(decision, decision.reason, steering.velocity if steering is not None else ZERO)
        if state is None or scene is None or steering is None or mind is None:
            return decided
        prediction, margin = self._look_ahead(mind, state, now_ns)
        reason, filtered, solve_time = decision.reason, None, 0.0
        if decision.mode == "run":
            started = self._stopwatch() if self._stopwatch else 0.0
            ahead = Ahead(steering.velocity, prediction, margin, state, scene)
            filtered, why = self._decide_plan(mind, ahead, now_ns)
            solve_time = self._stopwatch() - started if self._stopwatch else 0.0
            reason = why or reason
            if self.driving_since_ns is None:
                self.driving_since_ns = now_ns
        reason = self._why_in_the_end(decision.mode, reason, state, mind.robot, now_ns)
        return replace(
            decided,
            reason=reason,
            prediction=prediction,
            margin=margin,
            filtered=filtered,
            solve_time=solve_time,
        )

    def _stand(self) -> "_Decided":
        """After a fault: the emergency stop that was asked for; else hold, if this session has control."""
        state = self._perception.state
        holds: CommandMode | None = "hold" if state is not None and state.holder == self.session else None
        reason = f"fault: {self.fault}"
        return _Decided(Decision("estop" if self._supervision.estop else holds, reason), reason, ZERO)

    def _take(self, packet: Packet) -> None:
        state = self._perception.take(packet)
        if state is not None:
            self.round_trip.received(state, packet.arrived_ns)
            if state is self._perception.state and self._mind is not None:
                self._mind.innovations.observe(state)

    def _know_the_robot(self) -> "_Mind | None":
        """What the newest description makes of prediction and filter; None before the first one."""
        robot, mind = self._perception.description, self._mind
        if robot is None:
            return None
        if mind is None or not (robot is mind.robot or robot.same_robot(mind.robot)):
            known = Known(self._history, self.session, self._period, robot.lag)
            self._mind = mind = _Mind(
                robot,
                Innovations(known, self.scenario.margin.innovation_window),
                self._prediction_law(known),
                SafetyFilter(
                    self.scenario.controller,
                    self._controller,
                    robot,
                    trails=self._prediction_law.compensates_lag,
                ),
            )
        return mind

    def _look_ahead(self, mind: "_Mind", state: RobotState, now_ns: int) -> tuple[Prediction, Margin]:
        prediction = mind.predictor.predict(state, self._seq, now_ns, self.round_trip.mean)
        given = MarginInput(
            speed=norm(state.velocity),
            rtt_mean=self.round_trip.mean,
            rtt_std=self.round_trip.std,
            innovation=mind.innovations.largest,
            spread=prediction.spread,
        )
        return prediction, checked_margin(self._margin.evaluate(given))

    def _why_in_the_end(
        self, mode: CommandMode | None, reason: str, state: RobotState, robot: RobotDescription, now_ns: int
    ) -> str:
        """The reason, or the limit behind it; a robot that refuses all as stale answers with that alone."""
        if self.round_trip.count == 0 and not self._refused_after and state.refused.get("stale"):
            self._refused_after = self.round_trip.age(now_ns)
        if mode == "run" or self._refused_after:
            return self._beyond_limits(robot) or reason
        return reason

    def _beyond_limits(self, robot: RobotDescription) -> str:
        """Which setting the round trip is too long for, and what would do; empty where there is none."""
        resync_after = self.scenario.operator.resync_after if self._margin.resyncs else math.inf
        rtt = self.round_trip.mean if self.round_trip.count else self._refused_after
        return beyond_limits(rtt, resync_after, robot.max_age)

    def _decide_plan(self, mind: "_Mind", ahead: Ahead, now_ns: int) -> tuple[Filtered | None, str]:
        """The filtered plan, or None and why the robot shall stand."""
        if self._margin.resyncs and self.round_trip.age(now_ns) > self.scenario.operator.resync_after:
            # Rule 3: after silence nothing is known of what the robot did; stand until it answers.
            mind.filter.stand_still()
            return None, self._beyond_limits(mind.robot) or STALE_STATE
        filtered = mind.filter.filter(ahead)
        checked_plan(filtered.plan, self.scenario.controller.horizon)
        return filtered, filtered.reason

    def _velocities(self, filtered: Filtered | None) -> tuple[Vector3, ...]:
        """The velocity and what follows: the controller's plan, or a held velocity where the law has none."""
        n = self.scenario.controller.horizon
        if filtered is None:
            return (ZERO,) * n
        if self._prediction_law.knows_plan:
            return tuple((float(v[0]), float(v[1]), float(v[2])) for v in filtered.plan.tolist())
        return (to_vector3(filtered.plan[0]),) * n

    def _send(
        self,
        now_ns: int,
        mode: CommandMode,
        velocity: Vector3,
        plan: tuple[Vector3, ...],
        desired: Vector3,
        successor: int = 0,
    ) -> bytes:
        command = VelocityCommand(
            source=self.who.name,
            session=self.session,
            seq=self._seq,
            t_sent_ns=now_ns,
            echo=self._perception.newest_state.echo(now_ns),
            mode=mode,
            velocity=velocity,
            plan=plan,
            plan_period_ns=self._ticks.period_ns,
            desired=desired,
            successor=successor,
        )
        payload = encode(command)
        self._link.send(Packet(self._key, payload))
        return payload
