"""Operator side to its console and recorder: all that was seen and decided in a tick."""

from typing import Annotated

import msgspec
from msgspec import Meta

from farhand.common.messages.base import (
    ZERO,
    Message,
    Name,
    NameOrNone,
    NonNegative,
    Quaternion,
    Real,
    SafetyMode,
    Stamp,
    Text,
    Vector3,
)
from farhand.common.messages.command import CommandMode
from farhand.common.messages.intervention import Intervention

UPRIGHT: Quaternion = (1.0, 0.0, 0.0, 0.0)


class ControlReport(Message, frozen=True, kw_only=True):
    """What the operator side saw and decided in one tick; stays on the operator's side of the network.

    Attributes:
        tick: counts the ticks.
        mode: mode of the command sent.
        desired, filtered: velocity before and after the filter (m/s).
        desired_angular, angular: angular velocity before and after its limits (rad/s).
        intervening: whether the filter has a hand in the command: something binds, or a reason stands. This is
            what a run's interventions count.
        position, orientation: of the tool, as last reported (m).
        predicted: start state that the controller used (m).
        predicted_orientation: of the tool there, by the same commands.
        prediction_error: newest innovation (m).
        sigma: the paper's margin added to the barrier (m).
        inflation: radius inflation of the nearest obstacle: the law's, and what the lag adds to it (m).
        margin_parts: named parts of the margin (m); `lag` is what a body that trails behind its prediction costs.
        rtt, rtt_mean, rtt_std: network round trip, newest and over the window (s).
        loss: fraction of the states of the last seconds that never came; None: not known yet.
        age: age of the oldest unanswered command (s).
        state_age: of the last state: since it arrived, and what it was old already when the robot sent it (s).
        status: the solver's status.
        solve_time: (s).
        binding: id of the obstacle that binds, or empty.
        clearance, min_clearance: as the robot reported them (m).
        safety, safety_reason: the robot's watchdog.
        stop_reason: why the operator side commands zero, or empty.
        target_index, target_count: progress through the targets.
        refused_here: messages refused by this side.
        refused_there: commands refused by the robot.
        stops: stops counted by the robot.
        state_rate: states arriving per second.
        states: states that arrived so far.
        overruns: late control ticks.
        connected: whether the operator's program is connected to anything on the robot's side.
        held_by: what holds a robot that has made no progress for 3 s; empty while it makes some.
        blocked_by: the obstacle that stands in the way that is wanted, for more than 0.6 s; empty: none does.
        free_side: the side on which the way round it is free: `left`, `right`, `above` or `below` of who looks along
            the way that is wanted; empty: none is, or nothing is in the way.
        guard: what the guard on the robot did since the last tick, the newest; None: nothing.
        limit: distance that is kept without any margin (m); said by a program to who watches, never recorded.
        recording: whether a recorder has said in the last moment that it writes; left out where none ever did. As
            `limit`.
    """

    tick: Stamp
    mode: CommandMode
    desired: Vector3
    filtered: Vector3
    desired_angular: Vector3 = ZERO
    angular: Vector3 = ZERO
    intervening: bool
    position: Vector3
    orientation: Quaternion = UPRIGHT
    predicted: Vector3
    predicted_orientation: Quaternion = UPRIGHT
    prediction_error: Real
    sigma: Real
    inflation: Real
    margin_parts: Annotated[dict[Name, Real], Meta(max_length=16)] = msgspec.field(default_factory=dict)
    rtt: Real | None
    rtt_mean: Real | None
    rtt_std: Real | None
    loss: Real | None
    age: Real
    state_age: Real
    status: Name
    solve_time: Real
    binding: Annotated[str, Meta(max_length=64)] = ""
    clearance: Real | None
    min_clearance: Real | None
    safety: SafetyMode | None
    safety_reason: Text = ""
    stop_reason: Text = ""
    target_index: Stamp
    target_count: Stamp
    refused_here: Stamp
    refused_there: Stamp
    stops: Stamp
    state_rate: Real
    states: Stamp = 0
    overruns: Stamp
    connected: bool = True
    held_by: Text = ""
    blocked_by: NameOrNone = ""
    free_side: NameOrNone = ""
    guard: Intervention | None = None
    limit: NonNegative | msgspec.UnsetType = msgspec.UNSET
    recording: bool | msgspec.UnsetType = msgspec.UNSET
