"""What travels between the programs: MessagePack maps, one schema version, stamps from the sender's clock.

SI units, base frame, orientations as unit quaternions (w, x, y, z).
"""

from typing import Annotated, Literal

import msgspec
from msgspec import Meta, Struct

SCHEMA = 2
MAX_PLAN = 256
MAX_OBSTACLES = 1024
MAX_TARGETS = 256
MAX_JOINTS = 16
MAX_WAITING = 4

# Magnitudes beyond this are refused as nonsense: no position in m or velocity in m/s comes near it.
Real = Annotated[float, Meta(ge=-1e6, le=1e6)]
Positive = Annotated[float, Meta(gt=0, le=1e6)]
NonNegative = Annotated[float, Meta(ge=0, le=1e6)]
Vector3 = tuple[Real, Real, Real]
Quaternion = tuple[Real, Real, Real, Real]
Stamp = Annotated[int, Meta(ge=0, le=2**63 - 1)]
Duration = Annotated[int, Meta(ge=0, le=2**62)]
# Names are shown on terminals: no control characters, and nothing that turns the direction of writing.
_PRINTABLE = r"\A[^\x00-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069]*\Z"
Name = Annotated[str, Meta(min_length=1, max_length=64, pattern=_PRINTABLE)]
NameOrNone = Annotated[str, Meta(max_length=64, pattern=_PRINTABLE)]
Text = Annotated[str, Meta(max_length=512)]

CommandMode = Literal["run", "hold", "estop", "acknowledge", "release"]
SafetyMode = Literal["run", "hold", "stopped", "estop"]
LeaseEnd = Literal["", "released", "silent"]


class Echo(Struct, frozen=True, forbid_unknown_fields=True):
    """The newest message (by seq) received from the other side, so that it can measure the round trip.

    Attributes:
        session: its sender's session.
        seq: its sequence number.
        t_sent_ns: its stamp, on its sender's clock.
        hold_ns: how long it had been here when this echo was written.
    """

    session: Stamp
    seq: Stamp
    t_sent_ns: Stamp
    hold_ns: Duration


class Message(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The fields that every message has.

    Attributes:
        schema: version of these definitions.
        source: who sent it: the robot's name, or the operator's as it names itself.
        session: random, new at each start of the sender's process.
        seq: counts up by one a message of this kind and session.
        t_sent_ns: sender's monotonic clock; for a command the instant at which its tick began.
        echo: newest message received from the other side.
        check: CRC-32 of the bytes before it; the codec writes it as the last field, verifies it and takes it
            off again, so that a node never sees it. A foreign sender may leave it out.
    """

    schema: int = SCHEMA
    source: Name
    session: Stamp
    seq: Stamp
    t_sent_ns: Stamp
    echo: Echo | None = None
    check: Annotated[int, Meta(ge=0, le=2**32 - 1)] | msgspec.UnsetType = msgspec.UNSET


class VelocityCommand(Message, frozen=True, kw_only=True):
    """Operator to robot, once a tick.

    Attributes:
        mode: `run` moves; `hold` brakes; `estop` latches; `acknowledge` asks for control and clears a
            latched stop; `release` gives control up, or hands it over to `successor`.
        velocity: tool velocity now (m/s).
        plan: the rest of the plan after `velocity`, one velocity a period (m/s).
        plan_period_ns: period of the plan.
        desired: what the operator wanted before filtering (m/s).
        successor: with `release`: the waiting session that gets control (0: nobody).
    """

    mode: CommandMode
    velocity: Vector3
    plan: Annotated[tuple[Vector3, ...], Meta(max_length=MAX_PLAN)] = ()
    plan_period_ns: Annotated[int, Meta(ge=1_000_000, le=10_000_000_000)] = 100_000_000
    desired: Vector3 = (0.0, 0.0, 0.0)
    successor: Stamp = 0


class RobotState(Message, frozen=True, kw_only=True):
    """Robot to operator, at the state rate.

    Attributes:
        t_sample_ns: when the state was sampled, robot clock.
        position, velocity: of the tool (m, m/s).
        orientation: of the tool.
        joints: joint positions (rad).
        applied_session, applied_seq: the command now applied (0, 0: none yet).
        applied_for_ns: for how long it has been applied at `t_sample_ns`.
        mode, reason: state of the watchdog and why it is in it.
        holder: session that holds control (0: nobody).
        holder_name: its name, as it named itself (empty: nobody).
        lease_end: how the last lease ended: `released` by its holder, or its holder fell `silent`; empty
            while none has ended.
        waiting: session and name of those who asked in the last 3 s for control that another one holds.
        clearance: true distance from the robot's safety sphere to the nearest obstacle now (m).
        min_clearance: the smallest `clearance` since the start, at the robot's own rate (m).
        arm_clearance: distance of the whole arm to the nearest obstacle (m); None where not computed.
        refused: commands refused so far, by reason.
        received: command messages that arrived so far, whatever became of them.
        stops: times the watchdog left `run` for a stop.
    """

    t_sample_ns: Stamp
    position: Vector3
    velocity: Vector3
    orientation: Quaternion = (1.0, 0.0, 0.0, 0.0)
    joints: Annotated[tuple[Real, ...], Meta(max_length=MAX_JOINTS)] = ()
    applied_session: Stamp = 0
    applied_seq: Stamp = 0
    applied_for_ns: Duration = 0
    mode: SafetyMode = "hold"
    reason: Text = ""
    holder: Stamp = 0
    holder_name: NameOrNone = ""
    lease_end: LeaseEnd = ""
    waiting: Annotated[tuple[tuple[Stamp, Name], ...], Meta(max_length=MAX_WAITING)] = ()
    clearance: Real
    min_clearance: Real
    arm_clearance: Real | None = None
    refused: Annotated[dict[Name, Stamp], Meta(max_length=64)] = msgspec.field(default_factory=dict)
    received: Stamp = 0
    stops: Stamp = 0


class Obstacle(Struct, frozen=True, forbid_unknown_fields=True):
    """A spherical obstacle in the base frame.

    Attributes:
        id: its name.
        position: centre (m).
        radius: (m).
        velocity: (m/s).
    """

    id: Name
    position: Vector3
    radius: Positive
    velocity: Vector3 = (0.0, 0.0, 0.0)


class Scene(Message, frozen=True, kw_only=True):
    """Robot to operator, on change and once a second.

    Attributes:
        t_sample_ns: instant at which the obstacles were where they are said to be, robot clock.
        robot_radius: radius of the sphere around the tool that must stay clear (m).
        obstacles: what to avoid.
        targets: where to go, in order (m).
    """

    t_sample_ns: Stamp
    robot_radius: NonNegative
    obstacles: Annotated[tuple[Obstacle, ...], Meta(max_length=MAX_OBSTACLES)] = ()
    targets: Annotated[tuple[Vector3, ...], Meta(max_length=MAX_TARGETS)] = ()


class ControlReport(Message, frozen=True, kw_only=True):
    """What the operator side saw and decided in one tick; stays on the operator's side of the network.

    Attributes:
        tick: counts the ticks.
        mode: mode of the command sent.
        desired, filtered: velocity before and after the filter (m/s).
        intervening: whether the filter changed the command by more than 1 mm/s.
        position: tool position last reported (m).
        predicted: start state that the controller used (m).
        prediction_error: newest innovation (m).
        sigma: the paper's margin added to the barrier (m).
        inflation: radius inflation (m).
        margin_parts: named parts of the margin (m).
        rtt, rtt_mean, rtt_std: network round trip, newest and over the window (s).
        loss: fraction of commands or states known to be lost.
        age: age of the oldest unanswered command (s).
        state_age: time since the last state arrived (s).
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
    """

    tick: Stamp
    mode: CommandMode
    desired: Vector3
    filtered: Vector3
    intervening: bool
    position: Vector3
    predicted: Vector3
    prediction_error: Real
    sigma: Real
    inflation: Real
    margin_parts: Annotated[dict[Name, Real], Meta(max_length=16)] = msgspec.field(default_factory=dict)
    rtt: Real | None
    rtt_mean: Real | None
    rtt_std: Real | None
    loss: Real
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
