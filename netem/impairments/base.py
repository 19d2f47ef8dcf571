"""The interface of every impairment: a word of the SPEC (its parameters) and what it does to a message.

To add an impairment: one file with a `Word` (name, kind, stage; parse, text, build) and an `Impairment`
(apply), and one line in registry.py; or, from a package of your own, an entry point of the group
`farhand.impairments`. Rules that keep the same seed giving the same run:

- A message's draws depend on the seed, the direction, its key and how many messages of that key came
  before it, never on the clock: an impairment that draws does so for every message, lost ones too.
- Memory that counts messages (correlation, loss states) is kept per key: scope FLOW.
  Memory that counts time (queues, outages, slots) belongs to the whole direction: scope LINK.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum, IntEnum
from typing import TYPE_CHECKING, ClassVar

import msgspec
import numpy as np

from farhand.common.link.link import Packet
from farhand.common.seeds import stream

if TYPE_CHECKING:
    from farhand.netem.words.reader import SpecReader


class Stage(IntEnum):
    """The stated order in which a message passes the impairments of a direction.

    What stands at TCP (see Word.repairs) acts in place of OUTAGE and LOSS, and keeps the order after SLOT.
    """

    OUTAGE = 0
    LOSS = 1
    TCP = 2
    DUPLICATE = 3
    CORRUPT = 4
    RATE = 5
    DELAY = 6
    REORDER = 7
    SLOT = 8
    LIMIT = 9


class Scope(Enum):
    """Whose memory an impairment has: one key's, or that of all messages of the direction."""

    FLOW = "flow"
    LINK = "link"


@dataclass(slots=True)
class Flow:
    """All messages of one key in one direction.

    Attributes:
        key: the key.
        robot: whose key it is; "other" if none of ours.
        message_class: one of farhand.netem.spec.CLASSES.
        head, tail: what its messages pass, up to where they may be duplicated and from there on.
        copy_tail: the same for copies, whose draws must not shift those of the messages.
        count: messages so far.
        newest_released: largest ordinal that has been released.
        kind: of its messages, as in the key; empty if they are of many, or none of ours.
    """

    key: str
    robot: str
    message_class: str
    head: "list[Impairment]"
    tail: "list[Impairment]"
    copy_tail: "list[Impairment]"
    count: int = 0
    newest_released: int = -1
    kind: str = ""


@dataclass(frozen=True, slots=True)
class Pending:
    """Of a message whose release is only foretold.

    Attributes:
        puts_off: asked with the time (ns) once the release has come: whether it is put off, or dropped, which is
            then in the message's `release_ns` or `cause`.
    """

    puts_off: Callable[[int], bool]


class Transit(msgspec.Struct, eq=False):
    """One message, or one copy of it, on its way through a direction.

    Attributes:
        packet: the message; its payload is replaced only by `corrupt`.
        flow: of its key.
        size: payload bytes.
        ordinal: how many messages of its key came before it.
        arrived_ns: when it reached the emulator.
        release_ns: when it may leave, as far as decided.
        delay_ns: what the delay model drew.
        cause: why it is dropped; empty while it lives.
        copies: further copies that `duplicate` asks for.
        is_copy: whether it is such a copy.
        corrupted: the bit of the payload that was flipped; -1: none.
        retransmissions: times that `tcp-like` sent it again.
        offer_again: it was lost but must not be, and takes the chain again at `release_ns`.
        stamps: what the round-trip measurement remembers of it.
        pending: what may still put its release off; None: it leaves at `release_ns`.
    """

    packet: Packet
    flow: Flow
    size: int
    ordinal: int
    arrived_ns: int
    release_ns: int
    delay_ns: int = 0
    cause: str = ""
    copies: int = 0
    is_copy: bool = False
    corrupted: int = -1
    retransmissions: int = 0
    offer_again: bool = False
    stamps: object = None
    pending: "Pending | None" = None


class Impairment(ABC):
    """What happens to messages, one after the other in order of arrival.

    Attributes:
        below_zero: delays that it drew below zero and made zero.
        rest: what of one that stands before DUPLICATE acts on each copy by itself, after it; None: nothing.
    """

    below_zero: int = 0
    rest: "Impairment | None" = None

    @abstractmethod
    def apply(self, transit: Transit) -> None:
        """Decide: move `release_ns` later, or set `cause`, `copies`, `corrupted`. Never raises."""


def flip(transit: Transit, bit: int) -> None:
    """Flip one bit of a message's payload."""
    packet = transit.packet
    flipped = bytearray(packet.payload)
    flipped[bit // 8] ^= 1 << (bit % 8)
    transit.packet = Packet(packet.key, bytes(flipped), packet.arrived_ns, packet.envelope)
    transit.corrupted = bit


class LossModel(Impairment):
    """An impairment that can be asked again for a retransmission; what stands at LOSS or OUTAGE should be one.

    The losses of one that is none are for good, whatever repairs the others'.
    """

    @abstractmethod
    def loses(self, transit: Transit, instant_ns: int) -> bool:
        """Whether a transmission of the message at `instant_ns` is lost."""

    def apply(self, transit: Transit) -> None:
        """Lose the message or not."""
        if self.loses(transit, transit.arrived_ns):
            transit.cause = transit.cause or "loss"


class InOrder(Impairment):
    """No message leaves before one that came earlier."""

    def __init__(self) -> None:
        self._last_ns = 0

    def apply(self, transit: Transit) -> None:
        """Wait for those before."""
        if not transit.cause:
            self._last_ns = transit.release_ns = max(self._last_ns, transit.release_ns)


class Connection:
    """What a word that repairs losses remembers for all messages that share it; outlives changes of the word.

    Attributes:
        sent_ns: when the newest successful transmission so far leaves; what is behind it waits until then.
        order: keeps arrivals in order.
    """

    def __init__(self) -> None:
        self.sent_ns = 0
        self.order = InOrder()


@dataclass(frozen=True, slots=True)
class ImpairmentContext:
    """What an impairment is built with.

    Attributes:
        seed: of the run.
        direction: "uplink" or "downlink".
        owner: the key for scope FLOW, else the message class or "".
        origin_ns: instant that schedules count from.
        generation: how many times live control has replaced this word.
        robot: whose own network it is part of; empty: the common network.
    """

    seed: int
    direction: str
    owner: str
    origin_ns: int
    generation: int = 0
    robot: str = ""

    def rng(self, name: str) -> np.random.Generator:
        """The stream of this impairment's draws under `name`."""
        suffix = (str(self.generation),) if self.generation else ()
        return stream(self.seed, *self._network(), self.direction, name, self.owner, *suffix)

    def shared_rng(self, name: str) -> np.random.Generator:
        """A stream of which every owner in a network gets an equal copy, for what all flows must see alike."""
        return stream(self.seed, *self._network(), self.direction, name, "", str(self.generation))

    def _network(self) -> tuple[str, ...]:
        return ("netem", f"own:{self.robot}") if self.robot else ("netem",)


class Word(msgspec.Struct, frozen=True):
    """Parameters of one impairment, as a word of the SPEC says them.

    Class attributes:
        name: what it begins with in a SPEC.
        example: a whole word, or two joined by "or", for errors and lists.
        description: one line for lists.
        kind: what it acts on (delay, loss, rate, ...); a direction has one word of each kind.
        stage: its place in the chain.
        scope: whose memory it has.
        repairs: whether what the chain loses is sent again; such a word has `around` in place of `build`.
        alone: whether it is a whole network, beside which no other word has a place.
    """

    name: ClassVar[str]
    example: ClassVar[str] = ""
    description: ClassVar[str] = ""
    kind: ClassVar[str]
    stage: ClassVar[Stage]
    scope: ClassVar[Scope] = Scope.FLOW
    repairs: ClassVar[bool] = False
    alone: ClassVar[bool] = False

    @classmethod
    def parse(cls, reader: "SpecReader") -> "Word":
        """Read the parameters that follow the word's name, which is `reader.word`; raises SpecError."""
        raise NotImplementedError

    @classmethod
    def describe(cls, name: str) -> tuple[str, str]:
        """How to write the word that is registered under a name, and what it does: a row of a list."""
        return cls.example.partition(" or ")[0] or name, cls.description

    def text(self) -> str:
        """The canonical words, which parse back to an equal Word."""
        raise NotImplementedError

    def prepare(self) -> None:
        """Open what the word names, so that errors come before the start; raises InputError."""

    def build(self, context: ImpairmentContext) -> Impairment:
        """The impairment itself; raises InputError, e.g. for a file that cannot be read."""
        raise NotImplementedError

    def around(self, losses: Sequence[LossModel], connection: Connection) -> Impairment:
        """For a word that repairs: what acts in one key's chain in place of its losses and outages."""
        raise NotImplementedError
