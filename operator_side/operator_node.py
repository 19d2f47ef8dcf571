"""The operator's side, once a tick:

link -> perception (newest state, scene, description) -> round trip, innovations
     -> what this tick shall command (deciding.py)
     -> velocity command with its plan -> link,  and a report of it all.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from farhand.common.geometry import STILL, Twist
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
from farhand.operator_side.deciding import Decided, Decider, Senses
from farhand.operator_side.pace import pace_of
from farhand.operator_side.prediction.command_history import CommandHistory
from farhand.operator_side.prediction.response import Response
from farhand.operator_side.reporting import ReportWriter, Tick
from farhand.operator_side.sensing.perception import Perception
from farhand.operator_side.sensing.round_trip import RoundTrip
from farhand.operator_side.settings import OperatorScenario
from farhand.operator_side.steering.device import SteeringDevice
from farhand.operator_side.supervision import Supervision

REMEMBERED = 25.6
"""How long a command is remembered (s): beyond every round trip that anything is decided on."""


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
        pace = pace_of(scenario)
        self._ticks = Periodic(to_ns(pace.tick))
        self._step = pace.step
        self._perception = Perception(who.robot)
        self.round_trip = RoundTrip(who.session, max(2, pace.ticks(scenario.margin.rtt_span)))
        self._history = CommandHistory(pace.ticks(REMEMBERED))
        self._supervision = Supervision(who.session, who.name)
        senses = Senses(self._perception, self.round_trip, self._history, stopwatch)
        self._decider = Decider(scenario, controller, device, senses, self._supervision)
        self._writer = ReportWriter(who.name, who.session, self._perception, self.round_trip)
        self._seq = -1

    @property
    def fault(self) -> str:
        """What a kind got wrong, in one line: the node stands from then on; empty: nothing."""
        return self._decider.fault

    @property
    def response(self) -> Response:
        """How the robot really followed its commands so far: identified, beside what it says of itself."""
        return self._decider.response

    @property
    def driving_since_ns(self) -> int | None:
        """Instant of the first `run` command."""
        return self._decider.driving_since_ns

    @property
    def finished(self) -> bool:
        """Whether every target has been reached."""
        return self._decider.targets.finished

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
        self._supervision.stop()

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
            # Missed ticks use up sequence numbers: seq counts ticks, which the timeline relies on.
            self._seq += periods
            self._tick(now_ns)
        assert self._ticks.next_ns is not None
        return self._ticks.next_ns

    def correct(self, command: VelocityCommand) -> None:
        """Note what really was sent with the newest sequence number: a replay of another controller's run
        must predict from the commands that the robot got."""
        decided = self._history.get(command.seq)
        if decided is not None:
            self._history.add(
                command.seq,
                decided.t_sent_ns,
                self._step,
                (command.velocity, *command.plan),
                decided.predicted,
                (command.angular, *command.plan_angular),
            )

    def release(self, now_ns: int) -> None:
        """Give control up; the last command of a session."""
        self._seq += 1
        self._send(now_ns, "release", (ZERO,), (), STILL)

    def _tick(self, now_ns: int) -> None:
        packets = self._link.receive()
        for packet in packets:
            self._take(packet)
        decided = self._decider.step(self._seq, now_ns)
        payload = self._command(decided, now_ns)
        self.report = self._report(decided, now_ns)
        if self.recorder is not None:
            self.recorder.tick(now_ns, packets, payload, self.report)
        for listener in self.listeners:
            listener(self.report)

    def _take(self, packet: Packet) -> None:
        state = self._perception.take(packet)
        if state is not None:
            self.round_trip.received(state, packet.arrived_ns)
            if state is self._perception.state:
                self._decider.observe(state)

    def _command(self, decided: Decided, now_ns: int) -> bytes | None:
        """Note and send what was decided; the bytes that left, None where nothing is sent."""
        decision = decided.decision
        if decision.mode is None:
            return None
        velocities, turning = decided.velocities, decided.turning
        if not decision.asking:
            start = decided.prediction.start
            self._history.add(self._seq, now_ns, self._step, velocities, start, turning)
            self.round_trip.sent(self._seq, now_ns)
        return self._send(now_ns, decision.mode, velocities, turning, decided.desired, decision.successor)

    def _report(self, decided: Decided, now_ns: int) -> ControlReport:
        tick = Tick(
            now_ns=now_ns,
            seq=self._seq,
            mode=decided.decision.mode or "hold",
            reason=decided.reason,
            desired=decided.desired,
            sent=Twist(decided.velocities[0], *decided.turning[:1]),
            prediction=decided.prediction,
            prediction_error=decided.prediction_error,
            margin=decided.margin,
            filtered=decided.filtered,
            solve_time=decided.solve_time,
            overruns=self._ticks.overruns,
            blocked=decided.blocked,
        )
        return self._writer.write(tick, self._decider.targets)

    def _send(
        self,
        now_ns: int,
        mode: CommandMode,
        velocities: tuple[Vector3, ...],
        turning: tuple[Vector3, ...],
        desired: Twist,
        successor: int = 0,
    ) -> bytes:
        command = VelocityCommand(
            source=self.who.name,
            session=self.session,
            seq=self._seq,
            t_sent_ns=now_ns,
            echo=self._perception.newest_state.echo(now_ns),
            mode=mode,
            velocity=velocities[0],
            angular=turning[0] if turning else ZERO,
            plan=velocities[1:],
            plan_angular=turning[1:],
            plan_period_ns=to_ns(self._step),
            desired=desired.linear,
            desired_angular=desired.angular,
            successor=successor,
        )
        payload = encode(command)
        self._link.send(Packet(self._key, payload))
        return payload
