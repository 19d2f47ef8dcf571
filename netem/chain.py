"""One direction of the network: the impairments of a Spec in their stated order.

OUTAGE, LOSS, (or both as TCP), DUPLICATE, CORRUPT, RATE, DELAY, REORDER, SLOT, (TCP_ORDER).
"""

from collections.abc import Sequence
from typing import cast

from common.keys import kind_of, robot_of
from common.link import Packet
from netem.impairments.base import Context, Flow, Impairment, LossModel, Scope, Stage, Transit, Word
from netem.impairments.outage import OutageStage, Windows
from netem.impairments.reorder import InOrder
from netem.impairments.tcp_like import TcpLike
from netem.spec import CLASSES, Spec

MAX_FLOWS = 1024
_Built = dict[Word, Impairment]


class Chain:
    """Decides the fate of every message of one direction.

    Args:
        spec: what the direction is like.
        seed: of the run.
        direction: "uplink" (operator to robot) or "downlink".
    """

    def __init__(self, spec: Spec, seed: int, direction: str) -> None:
        spec.prepare()
        self.spec = spec
        self.direction = direction
        self._seed = seed
        self._origin_ns: int | None = None
        self._flows: dict[str, Flow] = {}
        self._built: dict[str, _Built] = {}
        self._shared: dict[str, _Built] = {}
        self._tcp_order: dict[str, InOrder] = {}
        self._generations: dict[tuple[str, str], int] = {}
        self._version = 0
        self._outages: list[tuple[Windows, OutageStage]] = []

    def start(self, origin_ns: int) -> None:
        """Set the instant that schedules count from; only the first call counts."""
        if self._origin_ns is None:
            self._origin_ns = origin_ns

    def offer(self, packet: Packet, now_ns: int) -> Sequence[Transit]:
        """The message with its fate, and its copies: each lives or has a `cause`."""
        flow = self._flows.get(packet.key)
        if flow is None:
            flow = self._new_flow(packet.key, now_ns)
        arrived_ns = min(packet.arrived_ns, now_ns) if packet.arrived_ns > 0 else now_ns
        transit = Transit(packet, flow, len(packet.payload), flow.count, arrived_ns, arrived_ns)
        flow.count += 1
        for impairment in flow.head:
            impairment.apply(transit)
        if not transit.copies:
            for impairment in flow.tail:
                impairment.apply(transit)
            return (transit,)
        transits = [transit]
        for _ in range(transit.copies):
            copy = Transit(packet, flow, transit.size, transit.ordinal, arrived_ns, transit.release_ns)
            copy.is_copy = True
            transits.append(copy)
        for each in transits:
            for impairment in flow.tail:
                impairment.apply(each)
        return transits

    def update(self, spec: Spec) -> None:
        """Take another Spec: words that stay keep their state, new ones start afresh; raises InputError."""
        spec.prepare()
        old, self.spec = self.spec, spec
        self._version += 1
        for name in ("", *CLASSES):
            known = set(_words(old, name))
            for word in _words(spec, name):
                if word not in known:
                    self._generations[name, word.kind] = self._version
                    if name in self._shared:
                        self._shared[name].pop(word, None)
        self._rebuild()

    def outage(self, now_ns: int, length_ns: int, hold: bool) -> None:
        """No network from now on for `length_ns`, for messages of every class."""
        windows = Windows([now_ns], [length_ns])
        self._outages = [pair for pair in self._outages if pair[0].end_ns(now_ns) is not None]
        self._outages.append((windows, OutageStage(windows, hold)))
        self._rebuild()

    def below_zero(self) -> int:
        """Delays that were drawn below zero and became zero."""
        return sum(
            getattr(impairment, "below_zero", 0)
            for built in self._built.values()
            for impairment in built.values()
        )

    def _rebuild(self) -> None:
        for flow in self._flows.values():
            flow.head, flow.tail = self._compile(flow.key, flow.message_class)

    def _new_flow(self, key: str, now_ns: int) -> Flow:
        self.start(now_ns)
        if len(self._flows) >= MAX_FLOWS:
            # A flood of keys must not grow the memory: the rest share one flow.
            key = "*"
            if key in self._flows:
                return self._flows[key]
        message_class = kind_of(key)
        message_class = message_class if message_class in CLASSES else "other"
        head, tail = self._compile(key, message_class)
        flow = Flow(key, robot_of(key) or "other", message_class, head, tail)
        self._flows[key] = flow
        return flow

    def _compile(self, key: str, message_class: str) -> tuple[list[Impairment], list[Impairment]]:
        """The impairments of one flow, built where they are new."""
        before = self._built.get(key, {})
        now: _Built = {}
        stages: list[tuple[Stage, Impairment]] = []
        for word, own in self.spec.words_for(message_class):
            owner = message_class if own else ""
            if word.scope is Scope.LINK:
                shared = self._shared.setdefault(owner, {})
                if word not in shared:
                    shared[word] = word.build(self._context(owner, owner, word.kind))
                stages.append((word.stage, shared[word]))
                continue
            now[word] = before.get(word) or word.build(self._context(key, owner, word.kind))
            stages.append((word.stage, now[word]))
            if isinstance(word, TcpLike):
                stages.append((Stage.TCP_ORDER, self._tcp_order.setdefault(owner, InOrder())))
        stages = [(Stage.OUTAGE, stage) for _, stage in self._outages] + stages
        self._built[key] = now
        stages = _repair(stages, next((word for word in now if isinstance(word, TcpLike)), None))
        stages.sort(key=lambda pair: pair[0])
        head = [impairment for stage, impairment in stages if stage <= Stage.DUPLICATE]
        return head, [impairment for stage, impairment in stages if stage > Stage.DUPLICATE]

    def _context(self, owner: str, message_class: str, kind: str) -> Context:
        generation = self._generations.get((message_class, kind), 0)
        return Context(self._seed, self.direction, owner, self._origin_ns or 0, generation)


def build_chain(spec: Spec, seed: int, direction: str) -> Chain:
    """The chain of one direction; raises InputError when a file that the Spec names cannot be read."""
    return Chain(spec, seed, direction)


def _words(spec: Spec, name: str) -> tuple[Word, ...]:
    if not name:
        return spec.words
    return next((words or () for known, words in spec.classes if known == name), ())


def _repair(stages: list[tuple[Stage, Impairment]], tcp: TcpLike | None) -> list[tuple[Stage, Impairment]]:
    """With `tcp-like` among them, the losses and outages act through it."""
    if tcp is None:
        return stages
    losses = [cast(LossModel, each) for stage, each in stages if stage in (Stage.OUTAGE, Stage.LOSS)]
    kept = [pair for pair in stages if pair[0] not in (Stage.OUTAGE, Stage.LOSS, Stage.TCP)]
    return [(Stage.TCP, tcp.around(losses)), *kept]
