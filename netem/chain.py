"""One direction of the network: the impairments of a Spec in their stated order.

OUTAGE, LOSS (or both through a word that repairs, such as tcp-like), DUPLICATE, CORRUPT, RATE, DELAY, REORDER,
SLOT, and the order of the word that repairs.
"""

from collections.abc import Hashable, Sequence

from farhand.common.link.link import Packet
from farhand.common.messages.keys import kind_of, robot_of
from farhand.netem.impairments.base import (
    Connection,
    Flow,
    Impairment,
    ImpairmentContext,
    LossModel,
    Scope,
    Stage,
    Transit,
    Word,
)
from farhand.netem.impairments.low_lane import LOW_CLASSES
from farhand.netem.impairments.outage import OutageStage, Windows
from farhand.netem.spec import CLASSES, Spec

MAX_FLOWS = 1024
_Built = dict[Hashable, Impairment]


class Chain:
    """Decides the fate of every message of one direction.

    Args:
        spec: what the direction is like.
        seed: of the run.
        direction: "uplink" (operator to robot) or "downlink".
        robot: whose own network it is, with streams of its own; empty: the common one.
        version: of the words at the start; another one begins other streams.

    Attributes:
        spec: what it is like now.
        version: grows with each change.
    """

    def __init__(self, spec: Spec, seed: int, direction: str, robot: str = "", version: int = 0) -> None:
        spec.prepare()
        self.spec = spec
        self.direction = direction
        self._seed = seed
        self._origin_ns: int | None = None
        self._flows: dict[str, Flow] = {}
        self._built: dict[str, _Built] = {}
        self._shared: dict[str, _Built] = {}
        self._connections: dict[str, Connection] = {}
        self._generations: dict[tuple[str, str], int] = {}
        self._robot = robot
        self._first = self.version = version
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
            for impairment in flow.copy_tail if each.is_copy else flow.tail:
                impairment.apply(each)
        return transits

    def update(self, spec: Spec) -> None:
        """Take another Spec: words that stay keep their state, new ones start afresh; raises InputError."""
        spec.prepare()
        old, self.spec = self.spec, spec
        self.version += 1
        for name in ("", *CLASSES):
            known = set(_words(old, name))
            for word in _words(spec, name):
                if word not in known:
                    self._generations[name, word.kind] = self.version
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
        everything = (*self._built.values(), *self._shared.values())
        return sum(impairment.below_zero for built in everything for impairment in built.values())

    def _rebuild(self) -> None:
        for flow in self._flows.values():
            flow.head, flow.tail, flow.copy_tail = self._compile(flow.key, flow.message_class)

    def _new_flow(self, key: str, now_ns: int) -> Flow:
        self.start(now_ns)
        if len(self._flows) >= MAX_FLOWS:
            # A flood of keys must not grow the memory: the rest share one flow.
            key = "*"
            if key in self._flows:
                return self._flows[key]
        kind = kind_of(key)
        message_class = kind if kind in CLASSES else "other"
        stages = self._compile(key, message_class)
        flow = Flow(key, robot_of(key) or "other", message_class, *stages, kind=kind)
        self._flows[key] = flow
        return flow

    def _compile(
        self, key: str, message_class: str
    ) -> tuple[list[Impairment], list[Impairment], list[Impairment]]:
        """Head, tail and tail for copies of one flow, built where they are new."""
        before = self._built.get(key, {})
        now: _Built = {}
        head: list[tuple[Stage, Impairment]] = [(Stage.OUTAGE, stage) for _, stage in self._outages]
        tail: list[Impairment] = []
        copy_tail: list[Impairment] = []
        repair: tuple[Word, Connection] | None = None
        words = self.spec.words_for(message_class)
        duplicates = any(word.stage is Stage.DUPLICATE for word, _ in words)
        for word, own in words:
            owner = message_class if own else ""
            if word.repairs:
                # What gives way travels apart, or its large messages would hold the others up by their order.
                line = message_class if message_class in LOW_CLASSES else owner
                repair = (word, self._connections.setdefault(line, Connection()))
                continue
            if word.scope is Scope.LINK:
                built = self._shared.setdefault(owner, {})
                impairment = _found_or_built(built, built, word, word, self._context(owner, owner, word.kind))
            else:
                impairment = _found_or_built(before, now, word, word, self._context(key, owner, word.kind))
            if word.stage <= Stage.DUPLICATE:
                head.append((word.stage, impairment))
                if impairment.rest is not None:
                    tail.append(impairment.rest)
                    copy_tail.append(impairment.rest)
                continue
            tail.append(impairment)
            if duplicates and _draws_anew(word):
                context = self._context(f"{key}#copy", owner, word.kind)
                impairment = _found_or_built(before, now, ("copy", word), word, context)
            copy_tail.append(impairment)
        self._built[key] = now
        if repair is not None:
            word, connection = repair
            tail.append(connection.order)
            copy_tail.append(connection.order)
            head = _repaired(head, word, connection)
        return [impairment for _, impairment in head], tail, copy_tail

    def _context(self, owner: str, message_class: str, kind: str) -> ImpairmentContext:
        generation = self._generations.get((message_class, kind), self._first)
        return ImpairmentContext(
            self._seed, self.direction, owner, self._origin_ns or 0, generation, self._robot
        )


def _words(spec: Spec, name: str) -> tuple[Word, ...]:
    if not name:
        return spec.words
    return next((words or () for known, words in spec.classes if known == name), ())


def _found_or_built(
    before: _Built, now: _Built, place: Hashable, word: Word, context: ImpairmentContext
) -> Impairment:
    """The impairment that is there already, with its state, or a new one."""
    found = now[place] = before.get(place) or word.build(context)
    return found


def _draws_anew(word: Word) -> bool:
    """Whether a copy passes an impairment of its own: its draws must not shift those of the messages."""
    return word.scope is Scope.FLOW and word.stage in (Stage.CORRUPT, Stage.DELAY)


def _repaired(
    head: list[tuple[Stage, Impairment]], word: Word, connection: Connection
) -> list[tuple[Stage, Impairment]]:
    """With a word that repairs among them, the losses and outages act through it."""
    losses: list[LossModel] = []
    kept: list[tuple[Stage, Impairment]] = []
    for stage, impairment in head:
        if stage < Stage.TCP and isinstance(impairment, LossModel):
            losses.append(impairment)
        else:
            kept.append((stage, impairment))
    return [(Stage.TCP, word.around(losses, connection)), *kept]
