"""What the robot's program leaves behind at the end of a run."""

import msgspec

from farhand.common.messages.base import SafetyMode, Vector3
from farhand.common.result_file import this_program


class Lateness(msgspec.Struct, frozen=True, kw_only=True):
    """How late the wake-ups of a real-time loop were (s), and whether it ran with SCHED_FIFO."""

    p50: float
    p99: float
    max: float
    realtime_priority: bool


class GuardedPair(msgspec.Struct, frozen=True, kw_only=True):
    """A part of the robot and an obstacle (or another part) for whose sake the guard acted.

    Attributes:
        part, obstacle: their names.
        seconds: for how long (s).
        distance: the least meanwhile (m).
    """

    part: str
    obstacle: str
    seconds: float
    distance: float


class RobotCounts(msgspec.Struct, frozen=True, kw_only=True):
    """What the robot counted and measured; all of it stands in a run's summary, too.

    Attributes:
        min_clearance: smallest true clearance of the tool's sphere (m); None without obstacles.
        min_arm_clearance: smallest true distance of the whole arm to an obstacle (m); None where not computed.
        path_length: way of the tool (m).
        ticks: control periods.
        overruns: of them, missed.
        states_sent, commands_received: messages.
        refused: commands that moved nothing, by reason.
        stops: latched stops.
        holds: changes from RUN to HOLD.
        longest_silence: longest time without a command of the one in control, until it released it (s).
        guarded: whether the guard was on.
        guard_times: how often it began to do something, half a second after it last did.
        guard_seconds: for how long it did something (s).
        guard_deeds: the same by what it did: slowed, turned, evading, braking (s).
        lateness: of the loop; None in virtual time.
        began: when it first followed a motion command (s since the first tick); None: it never did.
        scene_changes: how often its scene was changed.
        scene_refused: requests that did not change it, by reason.
    """

    min_clearance: float | None
    min_arm_clearance: float | None = None
    path_length: float = 0.0
    ticks: int
    overruns: int = 0
    states_sent: int = 0
    commands_received: int = 0
    refused: dict[str, int] = msgspec.field(default_factory=dict)
    stops: int
    holds: int = 0
    longest_silence: float = 0.0
    guarded: bool = False
    guard_times: int = 0
    guard_seconds: float = 0.0
    guard_deeds: dict[str, float] = msgspec.field(default_factory=dict)
    lateness: Lateness | None = None
    began: float | None = None
    scene_changes: int = 0
    scene_refused: dict[str, int] = msgspec.field(default_factory=dict)


class RobotResult(RobotCounts, frozen=True, kw_only=True, tag_field="program", tag="robot"):
    """What happened to the robot.

    Attributes:
        version, written_by: of the file.
        position: of the tool at the end (m).
        mode, reason: of the watchdog at the end.
        changes: (instant, mode, reason) of the watchdog's changes; ns, robot's clock.
        interruptions: (t, mode, reason) of holds for want of commands and of stops; s since the first tick.
        nearest_obstacle: to which the tool's sphere came nearest; empty without obstacles.
        nearest_part, nearest_to_arm: the part of the arm that came nearest to an obstacle, and that obstacle;
            empty where not computed.
        guard_pairs: for the sake of what the guard acted, longest first.
        trajectory: (t, x, y, z, clearance) at 50 Hz at most; s since the first tick, m.
    """

    version: int = 1
    written_by: str = msgspec.field(default_factory=this_program)
    position: Vector3 = (0.0, 0.0, 0.0)
    mode: SafetyMode = "hold"
    reason: str = ""
    changes: list[tuple[int, SafetyMode, str]] = msgspec.field(default_factory=list)
    interruptions: list[tuple[float, SafetyMode, str]] = msgspec.field(default_factory=list)
    nearest_obstacle: str = ""
    nearest_part: str = ""
    nearest_to_arm: str = ""
    guard_pairs: list[GuardedPair] = msgspec.field(default_factory=list)
    trajectory: list[tuple[float, float, float, float, float]] = msgspec.field(default_factory=list)
