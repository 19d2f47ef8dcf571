"""What became of every message at an emulator: enough to have the very same network again."""

from typing import Annotated, Literal

from msgspec import Meta, Struct

DELIVERED, ON_THE_WAY = "delivered", "on the way"
Direction = Literal["uplink", "downlink"]
FATE_TOPICS: dict[str, str] = {"uplink": "/network/uplink", "downlink": "/network/downlink"}


class Fate(Struct, frozen=True, kw_only=True):
    """One message, or one copy of it, once it left the emulator or was lost in it.

    Attributes:
        direction: which way it went.
        key: its Zenoh key.
        number: how many messages of its key came before it.
        copy: whether it is a further copy that the network made.
        size: of its payload (bytes).
        arrived_ns: when it reached the emulator, since the first message of any key (ns).
        drawn_ns: the delay that the delay's word drew (ns).
        assigned_ns: the delay that the whole network assigned (ns).
        achieved_ns: the delay that it had (ns); -1: lost.
        corrupted: the bit of its payload that was flipped; -1: none.
        fate: `delivered`; `on the way` when the run ended; or the word that lost it.
    """

    direction: Direction
    key: str
    number: Annotated[int, Meta(ge=0)]
    copy: bool = False
    size: int
    arrived_ns: int
    drawn_ns: int
    assigned_ns: Annotated[int, Meta(ge=0)]
    achieved_ns: int
    corrupted: int = -1
    fate: str = DELIVERED


FATES_KEY = "farhand/netem/fates"
"""Queryable of an emulator's program, on its own host: its newest fates, for a recorder."""


class FatesWanted(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Attributes:
    since: number of the first fate that is wanted.
    """

    since: Annotated[int, Meta(ge=0, le=2**62)]


class FateBatch(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Attributes:
    session: of the emulator's program.
    first: number of the first fate here.
    fates: in the order in which they were decided.
    more: there are further ones.
    epoch_ns: what must be added to `arrived_ns` for the time of day of the emulator's host (ns); 0: not started.
    uplink, downlink: the networks now, in words.
    seed: of their draws.
    sessions_ns: of each operator's session whose commands came by, what must be added to its stamps for `arrived_ns`
        (ns).
    """

    session: int
    first: int
    fates: tuple[Fate, ...]
    more: bool
    epoch_ns: int
    uplink: str
    downlink: str
    seed: int
    sessions_ns: dict[int, int] = {}
