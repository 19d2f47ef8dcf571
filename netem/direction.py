"""One way of the emulator: the common chain, the chains that robots have of their own, queue, statistics."""

import msgspec

from farhand.common.errors import InputError
from farhand.common.link.link import Link
from farhand.common.messages.keys import robot_of
from farhand.netem.chain import Chain
from farhand.netem.emulation import Emulation
from farhand.netem.measure.flow_statistics import FlowStatistics
from farhand.netem.measure.result import DirectionResult
from farhand.netem.measure.round_trips import MAX_ROBOTS
from farhand.netem.release_queue import ReleaseQueue
from farhand.netem.spec import Spec


class Direction:
    """One way: chains, queue, statistics.

    Args:
        name: "uplink" or "downlink".
        source, target: the links.
        emulation: what it is like, for all robots and for those that have a network of their own.

    Raises:
        InputError: a file that a Spec names cannot be read, or too many robots have their own.
    """

    def __init__(self, name: str, source: Link, target: Link, emulation: Emulation) -> None:
        self.name = name
        self.source, self.target = source, target
        self._initial, self._own_initial = emulation.spec(name), emulation.own_specs(name)
        self.chain = Chain(self._initial, emulation.seed, name)
        self.queue = ReleaseQueue(emulation.limits)
        self.robots: dict[str, FlowStatistics] = {}
        self.own_chains: dict[str, Chain] = {}
        self._seed = emulation.seed
        self._origin_ns: int | None = None
        self._versions: dict[str, int] = {}
        self._outages: list[tuple[int, int, bool]] = []
        self._below_zero = 0
        for robot, own in self._own_initial.items():
            self._give(robot, own)

    def start(self, origin_ns: int) -> None:
        """Set the instant that schedules count from."""
        self._origin_ns = origin_ns
        for chain in (self.chain, *self.own_chains.values()):
            chain.start(origin_ns)

    def chain_of(self, key: str) -> Chain:
        """The chain that a message under a key passes: its robot's own, else the common one."""
        return self.own_chains.get(robot_of(key), self.chain) if self.own_chains else self.chain

    def spec_for(self, robot: str) -> Spec:
        """What the direction is like for a robot; for an empty name, what the common network is like."""
        return self.own_chains.get(robot, self.chain).spec

    def has_own(self, robot: str) -> bool:
        """Whether a robot has a network of its own, or had one at the start."""
        return robot in self.own_chains or robot in self._own_initial

    def set_spec(self, spec: Spec, robot: str = "") -> None:
        """Change the common network, or a robot's own, which it gets if it has none; raises InputError."""
        if not robot:
            self.chain.update(spec)
        elif robot in self.own_chains:
            self.own_chains[robot].update(spec)
        else:
            self._give(robot, spec)

    def outage(self, now_ns: int, length_ns: int, hold: bool, robot: str = "") -> None:
        """No network from now on for `length_ns`: for all, or for one robot, which then has its own."""
        if robot:
            if robot not in self.own_chains:
                self._give(robot, self.chain.spec)
            self.own_chains[robot].outage(now_ns, length_ns, hold)
            return
        self._outages = [each for each in self._outages if each[0] + each[1] > now_ns]
        self._outages.append((now_ns, length_ns, hold))
        for chain in (self.chain, *self.own_chains.values()):
            chain.outage(now_ns, length_ns, hold)

    def outage_ends_ns(self, now_ns: int) -> int:
        """When the last of the outages for all that run now ends; `now_ns` if none does."""
        return max([now_ns, *(start_ns + length_ns for start_ns, length_ns, _ in self._outages)])

    def share(self, robot: str) -> None:
        """Take a robot back to the common network; what is queued keeps its fate."""
        chain = self.own_chains.pop(robot, None)
        if chain is not None:
            self._below_zero += chain.below_zero()
            self._versions[robot] = chain.version + 1

    def reset(self, robot: str = "") -> None:
        """Go back to the networks of the start: all, or one robot's."""
        if not robot:
            self.chain.update(self._initial)
        for name in [robot] if robot else [*self.own_chains, *self._own_initial]:
            if name in self._own_initial:
                self.set_spec(self._own_initial[name], name)
            else:
                self.share(name)

    def of(self, robot: str) -> FlowStatistics:
        """Statistics of one robot; the 257th and further share one."""
        found = self.robots.get(robot)
        if found is None:
            if len(self.robots) >= MAX_ROBOTS and robot != "other":
                return self.of("other")
            found = self.robots[robot] = FlowStatistics()
        return found

    def total(self) -> FlowStatistics:
        """All robots together."""
        total = FlowStatistics()
        for statistics in self.robots.values():
            total.merge(statistics)
        return total

    def summary(self) -> DirectionResult:
        """Everything that was counted so far."""
        chains = (self.chain, *self.own_chains.values())
        return DirectionResult(
            **msgspec.structs.asdict(self.total().summary()),
            spec=str(self.chain.spec),
            robot_specs={name: str(chain.spec) for name, chain in sorted(self.own_chains.items())},
            below_zero=self._below_zero + sum(chain.below_zero() for chain in chains),
            robots={name: statistics.summary() for name, statistics in sorted(self.robots.items())},
        )

    def _give(self, robot: str, spec: Spec) -> None:
        """A network of its own, in which the outages of the common one that run now go on."""
        if robot not in self._versions and len(self._versions) >= MAX_ROBOTS:
            raise InputError(f"robot {robot!r}: {MAX_ROBOTS} robots have had a network of their own already")
        chain = Chain(spec, self._seed, self.name, robot, self._versions.get(robot, 0))
        self._versions.setdefault(robot, 0)
        if self._origin_ns is not None:
            chain.start(self._origin_ns)
        for start_ns, length_ns, hold in self._outages:
            chain.outage(start_ns, length_ns, hold)
        self.own_chains[robot] = chain
