"""Two emulated links, one each way, between an operator's and a robot's side.

operator_link -> uplink chain -> release queue -> robot_link, and the same back. A message's fate is decided
when it arrives; it is released when its time has come. Times in schedules count from the first message.
"""

from collections import deque
from collections.abc import Callable, Sequence
from typing import Protocol

from farhand.common.errors import FarhandError
from farhand.common.link.link import Link, Packet
from farhand.common.messages.keys import kind_of
from farhand.common.recording.fates import DELIVERED, ON_THE_WAY, Fate
from farhand.netem.direction import Direction
from farhand.netem.emulation import Emulation
from farhand.netem.envelope import MustArrive
from farhand.netem.impairments.base import Transit
from farhand.netem.measure.flow_statistics import FlowStatistics
from farhand.netem.measure.histogram import Histogram
from farhand.netem.measure.result import NetemResult
from farhand.netem.measure.round_trips import MAX_ROBOTS, CommandMark, EchoMark, RoundTrips

DIRECTIONS = ("uplink", "downlink")
RETRANSMISSION_NS = 200_000_000


class ConservationError(FarhandError):
    """Messages appeared or vanished: a fault of the emulator itself."""


class MessageLog(Protocol):
    """Takes the fate of every message."""

    def record(self, fate: Fate) -> None:
        """A message was released, or lost; must not wait."""
        ...


class Schedule(Protocol):
    """Changes the network at given times (see farhand.netem.timeline)."""

    def start(self, origin_ns: int) -> None:
        """Set the instant of the first message."""
        ...

    def run(self, node: "NetemNode", now_ns: int) -> int | None:
        """Do what is due; returns when the next is."""
        ...


class NetemNode:
    """The emulator, told the time.

    Args:
        operator_link, robot_link: the two sides.
        emulation: what the network is like.
        logs: each takes the fate of every message.
        schedule: changes the network while it runs.
        instant: reads the time after a sending, so that the achieved delay holds the emulator's own
            work; without it the time of the step is taken (exact in virtual time).

    Raises:
        InputError: a file that a Spec names cannot be read.
    """

    def __init__(
        self,
        operator_link: Link,
        robot_link: Link,
        emulation: Emulation,
        *,
        logs: Sequence[MessageLog] = (),
        schedule: Schedule | None = None,
        instant: Callable[[], int] | None = None,
    ) -> None:
        up = Direction("uplink", operator_link, robot_link, emulation)
        down = Direction("downlink", robot_link, operator_link, emulation)
        self.directions = {"uplink": up, "downlink": down}
        self.round_trips: dict[str, RoundTrips] = {}
        self.changes = 0
        self._both = (up, down)
        self._logs = tuple(logs)
        self.origin_ns = 0
        self._schedule = schedule
        self._instant = instant
        self._started = False
        self._notes: deque[str] = deque(maxlen=100)

    def note(self, line: str) -> None:
        """Keep a line for whoever runs the node."""
        self._notes.append(line)

    def take_notes(self) -> list[str]:
        """The lines noted since the last call."""
        if not self._notes:
            return []
        notes = list(self._notes)
        self._notes.clear()
        return notes

    def step(self, now_ns: int) -> int | None:
        """Take in what has arrived, release what is due; returns the next release instant."""
        up, down = self._both
        commands, states = up.source.receive(), down.source.receive()
        if not self._started and (commands or states):
            firsts = [packets[0].arrived_ns or now_ns for packets in (commands, states) if packets]
            self._start(min(now_ns, *firsts))
        next_ns = self._schedule.run(self, now_ns) if self._schedule is not None and self._started else None
        for packet in commands:
            self._take(up, packet, now_ns)
        for packet in states:
            self._take(down, packet, now_ns)
        for direction in self._both:
            queue = direction.queue
            while (transit := queue.pop_due(now_ns)) is not None:
                self._release(direction, transit, now_ns)
            due_ns = queue.next_ns()
            if due_ns is not None and (next_ns is None or due_ns < next_ns):
                next_ns = due_ns
        return next_ns

    def sessions_ns(self) -> dict[int, int]:
        """What must be added to the stamps of an operator's session for the time since the first message (ns)."""
        return {
            session: offset_ns - self.origin_ns
            for trips in tuple(self.round_trips.values())
            for session, offset_ns in tuple(trips.offsets_ns.items())
        }

    @property
    def uplink_queued(self) -> int:
        """Messages on their way to robots."""
        return len(self._both[0].queue)

    def tell_rest(self) -> None:
        """Tell the logs of what is still on its way, once nothing is stepped any more."""
        for direction in self._both:
            for transit in direction.queue.waiting():
                self._note_fate(direction, transit, None, ON_THE_WAY)

    def conserved(self) -> bool:
        """Whether every message that came in is accounted for."""
        queued_right = all(d.total().queued == len(d.queue) for d in self._both)
        return queued_right and all(s.conserved() for d in self._both for s in d.robots.values())

    def check_conservation(self) -> None:
        """Raise ConservationError unless received + duplicated = delivered + dropped + queued, everywhere."""
        if not self.conserved():
            totals = {d.name: d.total().summary() for d in self._both}
            raise ConservationError(f"netem cannot account for every message: {totals}")

    def statistics(self) -> NetemResult:
        """Everything counted and measured so far."""
        rtt = Histogram()
        for trips in self.round_trips.values():
            rtt.merge(trips.rtt)
        uplink, downlink = (direction.summary() for direction in self._both)
        return NetemResult(
            uplink=uplink,
            downlink=downlink,
            rtt=rtt.summary(),
            rtt_by_robot={name: trips.rtt.summary() for name, trips in sorted(self.round_trips.items())},
            changes=self.changes,
            bypassed=sum(trips.bypassed for trips in self.round_trips.values()),
            conserved=self.conserved(),
        )

    def _start(self, origin_ns: int) -> None:
        self._started, self.origin_ns = True, origin_ns
        for direction in self._both:
            direction.start(origin_ns)
        if self._schedule is not None:
            self._schedule.start(origin_ns)

    def _take(self, direction: Direction, packet: Packet, now_ns: int) -> None:
        transits = direction.chain_of(packet.key).offer(packet, now_ns)
        first = transits[0]
        statistics = direction.of(first.flow.robot)
        statistics.received += 1
        statistics.duplicated += len(transits) - 1
        first.stamps = self._marks(direction.name, packet, first)
        for transit in transits:
            self._queue(direction, transit, statistics)

    def _queue(self, direction: Direction, transit: Transit, statistics: FlowStatistics) -> None:
        statistics.retransmitted += transit.retransmissions
        if transit.cause:
            if not isinstance(transit.packet.envelope, MustArrive):
                self._drop(direction, transit, statistics)
                return
            transit.offer_again = True
            transit.release_ns = max(transit.release_ns, transit.arrived_ns) + RETRANSMISSION_NS
        if direction.queue.push(transit):
            statistics.queued += 1
        else:
            transit.cause = "memory"
            self._drop(direction, transit, statistics)

    def _drop(self, direction: Direction, transit: Transit, statistics: FlowStatistics) -> None:
        statistics.dropped[transit.cause] += 1
        self._note_fate(direction, transit, None)

    def _release(self, direction: Direction, transit: Transit, now_ns: int) -> None:
        statistics = direction.of(transit.flow.robot)
        statistics.queued -= 1
        if transit.offer_again:
            self._offer_again(direction, transit, statistics, now_ns)
            return
        if transit.pending is not None and (transit.cause or transit.pending.puts_off(now_ns)):
            self._queue(direction, transit, statistics)
            return
        packet = transit.packet
        packet.arrived_ns = now_ns
        direction.target.send(packet)
        sent_ns = now_ns if self._instant is None else self._instant()
        statistics.delivered += 1
        achieved_ns = sent_ns - transit.arrived_ns
        statistics.drawn.add(transit.delay_ns)
        statistics.achieved.add(achieved_ns)
        statistics.error.add(max(0, sent_ns - transit.release_ns))
        if transit.corrupted >= 0:
            statistics.corrupted += 1
        flow = transit.flow
        if transit.ordinal > flow.newest_released:
            flow.newest_released = transit.ordinal
        elif not transit.is_copy and transit.ordinal < flow.newest_released:
            statistics.reordered += 1
        if isinstance(transit.stamps, CommandMark):
            transit.stamps.delivered = True
        elif isinstance(transit.stamps, EchoMark) and transit.corrupted < 0:
            self.round_trips[flow.robot].returned(transit.stamps, sent_ns)
        self._note_fate(direction, transit, sent_ns)

    def _note_fate(
        self, direction: Direction, transit: Transit, sent_ns: int | None, lived: str = DELIVERED
    ) -> None:
        """Tell the logs, if there are any, what became of a message; None: it is lost."""
        if not self._logs:
            return
        fate = Fate(
            direction="uplink" if direction.name == "uplink" else "downlink",
            key=transit.packet.key,
            number=transit.ordinal,
            copy=transit.is_copy,
            size=transit.size,
            arrived_ns=transit.arrived_ns - self.origin_ns,
            drawn_ns=transit.delay_ns,
            assigned_ns=transit.release_ns - transit.arrived_ns,
            achieved_ns=-1 if sent_ns is None else sent_ns - transit.arrived_ns,
            corrupted=transit.corrupted,
            fate=transit.cause or lived,
        )
        for log in self._logs:
            log.record(fate)

    def _offer_again(
        self, direction: Direction, transit: Transit, statistics: FlowStatistics, now_ns: int
    ) -> None:
        """A message that must arrive was lost: the sender tries again, as it would over TCP."""
        transit.packet.arrived_ns = now_ns
        again = direction.chain_of(transit.packet.key).offer(transit.packet, now_ns)[0]
        again.arrived_ns = transit.arrived_ns
        again.retransmissions += 1
        again.stamps = transit.stamps
        self._queue(direction, again, statistics)

    def _marks(self, direction: str, packet: Packet, transit: Transit) -> CommandMark | EchoMark | None:
        """What the round-trip measurement keeps with a command or an answer to one."""
        kind = transit.flow.kind or kind_of(packet.key)
        if kind not in ("command", "state", "scene", "description"):
            return None
        robot = transit.flow.robot
        trips = self.round_trips.get(robot)
        if trips is None:
            if len(self.round_trips) >= MAX_ROBOTS:
                return None
            trips = self.round_trips[robot] = RoundTrips()
        if direction == "uplink":
            return trips.command(packet.payload, transit.arrived_ns) if kind == "command" else None
        return trips.echo(packet.payload)
