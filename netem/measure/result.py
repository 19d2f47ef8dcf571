"""What the emulator counted and measured: what it leaves behind, shows while it runs, and serves as metrics."""

import msgspec

from farhand.common.result_file import this_program


class Delays(msgspec.Struct, frozen=True, kw_only=True):
    """Some durations (s): how many, mean, standard deviation, quantiles to 1%, the largest."""

    count: int = 0
    mean: float = 0.0
    std: float = 0.0
    p50: float = 0.0
    p99: float = 0.0
    max: float = 0.0


class FlowCounts(msgspec.Struct, frozen=True, kw_only=True):
    """Messages of one robot, or of all, in one direction.

    Attributes:
        received: messages that came in.
        duplicated: copies made.
        delivered: messages and copies that left.
        queued: that wait.
        dropped: by cause: loss, outage, queue (of the rate), trace, model or a profile's name (of a delay word that
            loses too), tcp-like, memory, superseded (of a camera's pictures that wait for the rate, by a newer one).
        corrupted: delivered with a flipped bit.
        reordered: delivered after one that came later.
        retransmitted: times a message was sent again.
        drawn: what the delay model drew for the delivered.
        achieved: from arrival to the end of the sending.
        error: achieved minus what the whole chain had assigned.
    """

    received: int = 0
    duplicated: int = 0
    delivered: int = 0
    queued: int = 0
    dropped: dict[str, int] = msgspec.field(default_factory=dict)
    corrupted: int = 0
    reordered: int = 0
    retransmitted: int = 0
    drawn: Delays = Delays()
    achieved: Delays = Delays()
    error: Delays = Delays()


class DirectionCounts(FlowCounts, frozen=True, kw_only=True):
    """All messages of one direction.

    Attributes:
        below_zero: draws that were raised to zero.
    """

    below_zero: int = 0


class DirectionResult(DirectionCounts, frozen=True, kw_only=True):
    """One direction.

    Attributes:
        spec: of the common network.
        robot_specs: of the robots that have a network of their own.
        robots: counts by robot.
    """

    spec: str = "none"
    robot_specs: dict[str, str] = msgspec.field(default_factory=dict)
    robots: dict[str, FlowCounts] = msgspec.field(default_factory=dict)


class KernelCounts(msgspec.Struct, frozen=True, kw_only=True):
    """What tc-netem counted on the network device of a direction: packets sent, packets dropped."""

    device: str
    direction: str
    packets: int
    dropped: int


class NetemCounts(msgspec.Struct, frozen=True, kw_only=True):
    """What stands in a run's summary, too.

    Attributes:
        uplink, downlink: all robots together.
        rtt: round trips, from the echoes that passed.
        bypassed: echoes of commands that went past the emulator.
        overflowed: messages lost before the emulator could take them.
        send_errors: messages that could not be sent.
        local: messages that came from the emulator itself.
        changes: how often live control or a timeline changed the network.
        tc: the kernel's counts, where it emulated.
    """

    uplink: DirectionCounts = DirectionCounts()
    downlink: DirectionCounts = DirectionCounts()
    rtt: Delays = Delays()
    bypassed: int = 0
    overflowed: int = 0
    send_errors: int = 0
    local: int = 0
    changes: int = 0
    tc: list[KernelCounts] = msgspec.field(default_factory=list)


class NetemResult(NetemCounts, frozen=True, kw_only=True, tag_field="program", tag="netem"):
    """What the emulator did; durations in s.

    Attributes:
        version, written_by: of the file.
        rtt_by_robot: round trips of each robot.
        conserved: whether every message is accounted for.
        seed: of all draws.
        realtime_priority: whether SCHED_FIFO was granted.
        peers: Zenoh ids of those connected, by side.
        both_sides: those connected to both.
    """

    version: int = 1
    written_by: str = msgspec.field(default_factory=this_program)
    uplink: DirectionResult = DirectionResult()
    downlink: DirectionResult = DirectionResult()
    rtt_by_robot: dict[str, Delays] = msgspec.field(default_factory=dict)
    conserved: bool = True
    seed: int | None = None
    realtime_priority: bool = False
    peers: dict[str, list[str]] = msgspec.field(default_factory=dict)
    both_sides: list[str] = msgspec.field(default_factory=list)

    @property
    def directions(self) -> dict[str, DirectionResult]:
        """By name: uplink, downlink."""
        return {"uplink": self.uplink, "downlink": self.downlink}
