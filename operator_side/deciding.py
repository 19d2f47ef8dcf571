"""What a tick shall command: from what is known of the robot to a mode, a plan and what is reported of it.

targets reached -> steering device (desired twist) -> supervision (mode)
-> state predictor (where the robot will be) -> margin -> safety filter (MPC-CBF), the turning beside it
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import msgspec
import numpy as np
from msgspec.structs import replace

from farhand.common.geometry import STILL, Array, Twist, norm, to_vector3
from farhand.common.messages.base import ZERO, Vector3
from farhand.common.messages.command import CommandMode
from farhand.common.messages.description import RobotDescription
from farhand.common.messages.scene import Scene
from farhand.common.messages.state import RobotState
from farhand.operator_side.control.controller import Controller
from farhand.operator_side.control.passing import changes, in_the_way
from farhand.operator_side.faults import checked_margin, checked_plan, checked_steering, told
from farhand.operator_side.margins.law import Margin, MarginInput
from farhand.operator_side.margins.registry import make_margin
from farhand.operator_side.pace import pace_of
from farhand.operator_side.prediction.command_history import CommandHistory
from farhand.operator_side.prediction.innovations import Innovations
from farhand.operator_side.prediction.law import Known, Prediction, StatePredictor
from farhand.operator_side.prediction.registry import PREDICTORS
from farhand.operator_side.prediction.response import Identification, Response
from farhand.operator_side.safety_filter import Ahead, Filtered, SafetyFilter
from farhand.operator_side.sensing.blockage import Blockage, Blocked
from farhand.operator_side.sensing.delay_limits import beyond_limits
from farhand.operator_side.sensing.perception import Perception
from farhand.operator_side.sensing.round_trip import RoundTrip
from farhand.operator_side.settings import OperatorScenario
from farhand.operator_side.steering.device import SteeringDevice, SteeringInput, View
from farhand.operator_side.steering.sides import Free
from farhand.operator_side.steering.targets import Targets
from farhand.operator_side.supervision import Decision, Supervision
from farhand.operator_side.turning import turning_plan

STALE_STATE = "no news from the robot: resynchronising"
FREE = 0.3
"""A velocity is free if the filter would change it by at most this share."""


@dataclass(frozen=True, slots=True)
class Mind:
    """What depends on the robot.

    Attributes:
        robot: as it describes itself.
        innovations: errors of the predictions so far.
        identification: how it really follows its commands.
        predictor: where it will be.
        filter: what it may do.
    """

    robot: RobotDescription
    innovations: Innovations
    identification: Identification
    predictor: StatePredictor
    filter: SafetyFilter


class Look(msgspec.Struct, frozen=True):
    """What is known of the robot in a tick: newest state and scene, where it will be, and how wrong that may be."""

    state: RobotState
    scene: Scene
    prediction: Prediction
    margin: Margin


class Decided(msgspec.Struct, frozen=True):
    """What a tick shall command; see reporting.Tick for what is not said here.

    Attributes:
        velocities, turning: the velocity and the angular velocity, and the plans after them (m/s, rad/s).
        blocked: what stands in the way that is wanted.
    """

    decision: Decision
    reason: str
    desired: Twist = STILL
    velocities: tuple[Vector3, ...] = ()
    turning: tuple[Vector3, ...] = ()
    prediction: Prediction = msgspec.field(default_factory=lambda: Prediction(ZERO))
    prediction_error: float = 0.0
    margin: Margin = msgspec.field(default_factory=Margin)
    filtered: Filtered | None = None
    solve_time: float = 0.0
    blocked: Blocked = msgspec.field(default_factory=Blocked)


@dataclass(frozen=True, slots=True)
class Senses:
    """What a decision is made from; others keep it up to date.

    Attributes:
        perception: newest state, scene and description.
        round_trip: measured.
        history: the commands sent.
        stopwatch: reads seconds, to report how long a solve took; None reports 0 (virtual time).
    """

    perception: Perception
    round_trip: RoundTrip
    history: CommandHistory
    stopwatch: Callable[[], float] | None = None


class Decider:
    """See the module's docstring.

    Args:
        scenario: settings; obstacles and targets come over the wire instead.
        controller: the safety filter, prepared.
        device: what steers.
        senses: what is known.
        supervision: of this session.

    Attributes:
        targets: progress through them.
        fault: what a kind got wrong, in one line: the robot stands from then on.
        driving_since_ns: instant of the first `run` command.
    """

    def __init__(
        self,
        scenario: OperatorScenario,
        controller: Controller,
        device: SteeringDevice,
        senses: Senses,
        supervision: Supervision,
    ) -> None:
        self._scenario, self._controller, self._device = scenario, controller, device
        self._perception, self._round_trip, self._senses = senses.perception, senses.round_trip, senses
        self._supervision, self._session = supervision, supervision.session
        self._pace = pace_of(scenario)
        self._margin = make_margin(scenario.margin)
        predictor = scenario.operator.predictor or self._margin.predictor
        self._prediction_law = PREDICTORS.get(predictor, "operator.predictor")
        self._mind: Mind | None = None
        self._described: RobotDescription | None = None  # the last one that said the same of the robot
        self._blockage = Blockage()
        self._refused_after = 0.0  # s from the first command to news of stale ones
        self.targets = Targets(scenario.operator.tolerance)
        self.fault = ""
        self.driving_since_ns: int | None = None

    def observe(self, state: RobotState) -> None:
        """Learn from the newest state how good the predictions were."""
        if self._mind is not None:
            self._mind.innovations.observe(state)
            self._mind.identification.observe(state)

    @property
    def response(self) -> Response:
        """How the robot really followed its commands so far."""
        return self._mind.identification.estimate() if self._mind is not None else Response()

    def step(self, seq: int, now_ns: int) -> Decided:
        """What command `seq` shall be; after a kind's fault, standing still. Never raises."""
        try:
            decided = self._stand(now_ns) if self.fault else self._decide(seq, now_ns)
        except Exception as error:  # of a law, a device or a controller: nothing throws in a control loop
            self.fault = told(error)
            decided = self._stand(now_ns)
        horizon, mind = self._scenario.controller.horizon, self._mind
        limit = self._scenario.controller.angular_limit
        if mind is not None:
            limit = min(limit, mind.robot.max_angular_speed)
        return replace(
            decided,
            velocities=self._velocities(decided.filtered),
            turning=turning_plan(decided.desired.angular, limit, decided.filtered, horizon),
            prediction_error=mind.innovations.newest if mind is not None else 0.0,
        )

    def _decide(self, seq: int, now_ns: int) -> Decided:
        """What this tick shall command; raises whatever a kind raises."""
        state, scene = self._perception.state, self._perception.scene
        mind = self._know_the_robot()
        steering, look = None, None
        if state is not None and scene is not None and mind is not None:
            driving = state.holder == self._session
            self.targets.update(state, scene, driving=driving)
            prediction, margin = self._look_ahead(mind, state, seq, now_ns)
            look = Look(state, scene, prediction, margin)
            view = View(state, scene, self.targets, now_ns, self._free(mind, prediction), driving,
                        stopping=self._supervision.estop)  # fmt: skip
            steering = checked_steering(self._device.read(view))
        self._supervision.twins = self._perception.twins(now_ns)
        decision = self._supervision.step(state, self._perception.lacking, steering, now_ns)
        decided = Decided(decision, decision.reason)
        if steering is None or mind is None or look is None:
            return decided
        decided = replace(decided, desired=Twist(steering.velocity, steering.angular))
        return self._decide_motion(mind, decided, look, steering, now_ns)

    def _decide_motion(
        self, mind: Mind, decided: Decided, look: Look, steering: SteeringInput, now_ns: int
    ) -> Decided:
        """The plan, if the mode is to move, and what is said of it."""
        mode, reason = decided.decision.mode, decided.reason
        filtered, solve_time, blocked = None, 0.0, Blocked()
        if mode == "run":
            watch = self._senses.stopwatch
            started = watch() if watch else 0.0
            ahead = Ahead(steering.velocity, look.prediction, look.margin, look.state, look.scene)
            filtered, why = self._decide_plan(mind, ahead, now_ns)
            solve_time = watch() - started if watch else 0.0
            reason = why or reason
            blocked = self._look_for_blocks(mind, look, steering.velocity, now_ns)
            if self.driving_since_ns is None:
                self.driving_since_ns = now_ns
        else:
            self._blockage.reset()
        return replace(
            decided,
            reason=self._why_in_the_end(mode, reason, look.state, mind.robot, now_ns),
            prediction=look.prediction,
            margin=look.margin,
            filtered=filtered,
            solve_time=solve_time,
            blocked=blocked,
        )

    def _stand(self, now_ns: int) -> Decided:
        """After a fault: the emergency stop that was asked for; else hold, if this session has control."""
        state = self._perception.state
        self._supervision.confirm(state, now_ns)
        holds: CommandMode | None = "hold" if state is not None and state.holder == self._session else None
        reason = f"fault: {self.fault}"
        return Decided(Decision("estop" if self._supervision.estop else holds, reason), reason)

    def _know_the_robot(self) -> Mind | None:
        """What the newest description makes of prediction and filter; None before the first one."""
        robot, mind, settings = self._perception.description, self._mind, self._scenario.controller
        if robot is None:
            return None
        if robot is self._described and mind is not None:
            return mind
        self._described = robot
        if mind is None or not robot.same_robot(mind.robot):
            pace = self._pace
            known = Known(self._senses.history, self._session, pace.tick, robot.lag)
            trails = self._prediction_law.compensates_lag
            self._mind = mind = Mind(
                robot,
                Innovations(known, pace.ticks(self._scenario.margin.innovation_span)),
                Identification(known),
                self._prediction_law(known),
                SafetyFilter(settings, self._controller, robot, trails=trails, tick=pace.tick),
            )
        return mind

    def _look_ahead(self, mind: Mind, state: RobotState, seq: int, now_ns: int) -> tuple[Prediction, Margin]:
        prediction = mind.predictor.predict(state, seq, now_ns, self._round_trip.mean)
        given = MarginInput(
            speed=norm(state.velocity),
            rtt_mean=self._round_trip.mean,
            rtt_std=self._round_trip.std,
            innovation=mind.innovations.largest,
            spread=prediction.spread,
            rtt_newest=self._round_trip.newest or 0.0,
            age=self._round_trip.age(now_ns),
            loss=self._round_trip.loss or 0.0,
            period=self._pace.tick,
        )
        return prediction, checked_margin(self._margin.evaluate(given))

    def _free(self, mind: Mind, prediction: Prediction) -> Free:
        """Which velocities the filter would let pass nearly as they are, from where the robot will be."""

        def free(velocities: Array | Sequence[Vector3]) -> Sequence[bool]:
            problem = mind.filter.problem_from(prediction.start)
            if problem is None:
                return [True] * len(velocities)
            asked = np.asarray(velocities, dtype=float).reshape(-1, 3)
            change = changes(problem, asked, self._scenario.controller)
            verdicts: list[bool] = (change <= FREE * np.linalg.norm(asked, axis=1)).tolist()
            return verdicts

        return free

    def _look_for_blocks(self, mind: Mind, look: Look, wanted: Vector3, now_ns: int) -> Blocked:
        def obstacle() -> str:
            problem = mind.filter.problem_from(look.prediction.start)
            if problem is None:
                return ""
            return mind.filter.name_of(in_the_way(problem, np.array(wanted), self._scenario.controller))

        free = self._free(mind, look.prediction)
        return self._blockage.look(wanted, look.state, free, obstacle, now_ns)

    def _why_in_the_end(
        self, mode: CommandMode | None, reason: str, state: RobotState, robot: RobotDescription, now_ns: int
    ) -> str:
        """The reason, or the limit behind it; a robot that refuses all as stale answers with that alone."""
        if self._round_trip.count == 0 and not self._refused_after and state.refused.get("stale"):
            self._refused_after = self._round_trip.age(now_ns)
        if mode == "run" or self._refused_after:
            return self._beyond_limits(robot) or reason
        return reason

    def _beyond_limits(self, robot: RobotDescription) -> str:
        """Which setting the round trip is too long for, and what would do; empty where there is none."""
        resync_after = self._scenario.operator.resync_after if self._margin.resyncs else math.inf
        rtt = self._round_trip.mean if self._round_trip.count else self._refused_after
        return beyond_limits(rtt, resync_after, robot.max_age)

    def _decide_plan(self, mind: Mind, ahead: Ahead, now_ns: int) -> tuple[Filtered | None, str]:
        """The filtered plan, or None and why the robot shall stand."""
        if self._margin.resyncs and self._round_trip.age(now_ns) > self._scenario.operator.resync_after:
            # Rule 3: after silence nothing is known of what the robot did; stand until it answers.
            mind.filter.stand_still()
            return None, self._beyond_limits(mind.robot) or STALE_STATE
        filtered = mind.filter.filter(ahead)
        checked_plan(filtered.plan, self._scenario.controller.horizon)
        return filtered, filtered.reason

    def _velocities(self, filtered: Filtered | None) -> tuple[Vector3, ...]:
        """The velocity and what follows: the controller's plan, or a held velocity where the law has none."""
        n = self._scenario.controller.horizon
        if filtered is None:
            return (ZERO,) * n
        if self._prediction_law.knows_plan:
            return tuple((float(v[0]), float(v[1]), float(v[2])) for v in filtered.plan.tolist())
        return (to_vector3(filtered.plan[0]),) * n
