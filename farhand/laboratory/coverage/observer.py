"""Holds each command of a drive against what became of it: known in virtual time, where both ends can be heard.

A margin is chosen when a command leaves. Later it turns out where the robot really was when that command took effect,
and how long it took until the operator's side was answered. Only what was known at the time counts for the margin.
"""

import math
from collections import deque
from dataclasses import dataclass, field

from farhand.common.link.link import Packet
from farhand.common.messages.codec import Decoder
from farhand.common.messages.keys import state_key
from farhand.common.messages.report import ControlReport
from farhand.common.messages.state import RobotState
from farhand.operator_side.margins.law import MarginInput, MarginLaw


@dataclass(slots=True)
class Chosen:
    """A command that left, and what was reckoned with.

    Attributes:
        t_sent_ns: when it left.
        predicted: where the robot would be when it takes effect (m).
        velocity: that it asks for (m/s).
        width: of the margin: what the radii and the barrier got on top (m).
        reckoned: the longest round trip that the margin pays for (s); None: the law does not reckon with any.
        error: between `predicted` and where the robot really was (m); None: it never took effect.
        answered: until the robot's first answer to it, or to a later one, came (s); None: none did.
    """

    t_sent_ns: int
    predicted: tuple[float, float, float]
    velocity: tuple[float, float, float]
    width: float
    reckoned: float | None
    error: float | None = None
    answered: float | None = None


@dataclass(slots=True)
class Observer:
    """Listens to the reports of an operator and to the states of its robot, on both ends.

    Attributes:
        robot: its name.
        lag: of its velocity response (s).
        law: of the margin in force.
        compensates: whether predictions are of z = x + lag v.
        period: from one command to the next (s).
        commands: that left, by number, while the robot was driven.
    """

    robot: str
    lag: float
    law: MarginLaw
    compensates: bool
    period: float
    commands: dict[int, Chosen] = field(default_factory=dict)
    _waiting: deque[int] = field(default_factory=deque)
    _applied: int = -1
    _sent: Decoder[RobotState] = field(default_factory=lambda: Decoder(RobotState))
    _got: Decoder[RobotState] = field(default_factory=lambda: Decoder(RobotState))

    def heard(self, report: ControlReport) -> None:
        """A tick of the operator."""
        if report.mode != "run":
            return
        given = MarginInput(
            speed=0.0,
            rtt_mean=report.rtt_mean or 0.0,
            rtt_std=report.rtt_std or 0.0,
            innovation=0.0,
            spread=0.0,
            rtt_newest=report.rtt or 0.0,
            age=report.age,
            loss=report.loss or 0.0,
            period=self.period,
        )
        lag = report.margin_parts.get("lag", 0.0)
        self.commands[report.seq] = Chosen(
            report.t_sent_ns,
            report.predicted,
            report.filtered,
            report.sigma + report.inflation - lag,
            self.law.round_trip(given) if report.rtt_mean is not None else None,
        )
        self._waiting.append(report.seq)

    def robot_sent(self, packet: Packet) -> None:
        """A state as the robot knew it: the first one under a command tells where it took effect."""
        state = self._sent.decode(packet.payload) if packet.key == state_key(self.robot) else None
        if state is None or state.applied_seq <= self._applied:
            return
        self._applied = state.applied_seq
        command = self.commands.get(state.applied_seq)
        if command is None:
            return
        since = state.applied_for_ns * 1e-9
        # Back to the instant of effect: z = x + lag v has gone by the command since, the body by its own velocity.
        began = [
            x + self.lag * v - u * since if self.compensates else x - v * since
            for x, v, u in zip(state.position, state.velocity, command.velocity, strict=True)
        ]
        command.error = math.dist(began, command.predicted)

    def operator_got(self, packet: Packet, now_ns: int) -> None:
        """A state that arrived: it answers the command that it echoes and all before it."""
        state = self._got.decode(packet.payload) if packet.key == state_key(self.robot) else None
        if state is None or state.echo is None:
            return
        while self._waiting and self._waiting[0] <= state.echo.seq:
            command = self.commands[self._waiting.popleft()]
            command.answered = (now_ns - command.t_sent_ns - state.echo.hold_ns) * 1e-9
