"""Robot to operator: where it is and what it does."""

from typing import Annotated, Literal

import msgspec
from msgspec import Meta

from farhand.common.messages.base import (
    Duration,
    Message,
    Name,
    NameOrNone,
    Quaternion,
    Real,
    SafetyMode,
    Stamp,
    Text,
    Vector3,
)
from farhand.common.messages.intervention import Intervention

MAX_JOINTS = 16
MAX_WAITING = 4

ESTOP_BY = "emergency stop by "
"""What `reason` begins with in an emergency stop, before the name of whoever asked for it last."""
FAULT = "fault: "
"""What `reason` begins with where something in the robot failed."""

LeaseEnd = Literal["", "released", "silent"]


class RobotState(Message, frozen=True, kw_only=True):
    """Robot to operator, at the state rate.

    Attributes:
        t_sample_ns: when the state was sampled, robot clock.
        position, velocity: of the tool (m, m/s).
        orientation: of the tool.
        angular_velocity: of the tool, about base's axes (rad/s).
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
        evades: whether its guard may still move it, out of the way of what moves, though it is stopped; left out where
            it may not, or the robot is not stopped.
        guard: what the guard did since the last state, the newest; left out where nothing.
        held_by: what keeps the robot from following its command, such as a joint's limit; left out where nothing
            does.
    """

    t_sample_ns: Stamp
    position: Vector3
    velocity: Vector3
    orientation: Quaternion = (1.0, 0.0, 0.0, 0.0)
    angular_velocity: Vector3 = (0.0, 0.0, 0.0)
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
    held_by: NameOrNone | msgspec.UnsetType = msgspec.UNSET
    guard: Intervention | msgspec.UnsetType = msgspec.UNSET
    evades: bool | msgspec.UnsetType = msgspec.UNSET

    @property
    def sample_age(self) -> float:
        """How old it was already when it was sent (s): a robot whose own controller has fallen silent knows no more."""
        return max(0, self.t_sent_ns - self.t_sample_ns) * 1e-9
