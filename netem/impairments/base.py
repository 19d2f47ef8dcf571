"""The interface of every impairment: a word of the SPEC (its parameters) and what it does to a message.

To add an impairment: one file with a `Word` (parse, text, build) and an `Impairment` (apply), and one
line in registry.py. Rules that keep the same seed giving the same run:

- A message's draws depend on the seed, the direction, its key and how many messages of that key came
  before it, never on the clock: an impairment that draws does so for every message, lost ones too.
- Memory that counts messages (correlation, loss states) is kept per key: scope FLOW.
  Memory that counts time (queues, outages, slots) belongs to the whole direction: scope LINK.
"""

from dataclasses import dataclass
from enum import Enum, IntEnum
from typing import TYPE_CHECKING, ClassVar, Protocol

import msgspec
import numpy as np

from farhand.common.link.link import Packet
from farhand.common.seeds import stream

if TYPE_CHECKING:
    from farhand.netem.words.reader import Reader


class Stage(IntEnum):
    """The stated order in which a message passes the impairments of a direction."""

    OUTAGE = 0
    LOSS = 1
    TCP = 2
    DUPLICATE = 3
    CORRUPT = 4
    RATE = 5
    DELAY = 6
    REORDER = 7
    SLOT = 8
    TCP_ORDER = 9


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
    """

    key: str
    robot: str
    message_class: str
    head: "list[Impairment]"
    tail: "list[Impairment]"
    copy_tail: "list[Impairment]"
    count: int = 0
    newest_released: int = -1


@dataclass(slots=True)
class Transit:
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
        corrupted: whether a bit was flipped.
        retransmissions: times that `tcp-like` sent it again.
        offer_again: it was lost but must not be, and takes the chain again at `release_ns`.
        stamps: what the round-trip measurement remembers of it.
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
    corrupted: bool = False
    retransmissions: int = 0
    offer_again: bool = False
    stamps: object = None


class Impairment(Protocol):
    """What happens to messages, one after the other in order of arrival."""

    def apply(self, transit: Transit) -> None:
        """Decide: move `release_ns` later, or set `cause`, `copies`, `corrupted`. Never raises."""
        ...


class LossModel(Impairment, Protocol):
    """An impairment that `tcp-like` can ask again, for a retransmission."""

    def loses(self, transit: Transit, instant_ns: int) -> bool:
        """Whether a transmission of the message at `instant_ns` is lost."""
        ...


@dataclass(frozen=True, slots=True)
class Context:
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
        kind: what it acts on (delay, loss, rate, ...); a direction has one word of each kind.
        stage: its place in the chain.
        scope: whose memory it has.
    """

    kind: ClassVar[str]
    stage: ClassVar[Stage]
    scope: ClassVar[Scope] = Scope.FLOW

    @classmethod
    def parse(cls, reader: "Reader") -> "Word":
        """Read the parameters that follow the word's name; raises SpecError."""
        raise NotImplementedError

    def text(self) -> str:
        """The canonical words, which parse back to an equal Word."""
        raise NotImplementedError

    def prepare(self) -> None:
        """Open what the word names, so that errors come before the start; raises InputError."""

    def build(self, context: Context) -> Impairment:
        """The impairment itself; raises InputError, e.g. for a file that cannot be read."""
        raise NotImplementedError
