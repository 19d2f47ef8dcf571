"""The fields and the kinds of numbers that all messages share; MessagePack maps, one schema version.

SI units, base frame, orientations as unit quaternions (w, x, y, z), stamps from the sender's clock.
"""

from typing import Annotated, Literal

import msgspec
from msgspec import Meta, Struct

from farhand.common.quantities import PRINTABLE
from farhand.common.quantities import ZERO as ZERO
from farhand.common.quantities import Name as Name
from farhand.common.quantities import NonNegative as NonNegative
from farhand.common.quantities import Positive as Positive
from farhand.common.quantities import Quaternion as Quaternion
from farhand.common.quantities import Real as Real
from farhand.common.quantities import Vector3 as Vector3

SCHEMA = 4

Stamp = Annotated[int, Meta(ge=0, le=2**63 - 1)]
Duration = Annotated[int, Meta(ge=0, le=2**62)]
NameOrNone = Annotated[str, Meta(max_length=64, pattern=PRINTABLE)]
Text = Annotated[str, Meta(max_length=512)]

SafetyMode = Literal["run", "hold", "stopped", "estop"]


class Echo(Struct, frozen=True, forbid_unknown_fields=True):
    """The newest message (by seq) received from the other side, so that it can measure the round trip.

    Attributes:
        session: its sender's session.
        seq: its sequence number.
        t_sent_ns: its stamp, on its sender's clock.
        hold_ns: how long it had been here when this echo was written.
    """

    session: Stamp
    seq: Stamp
    t_sent_ns: Stamp
    hold_ns: Duration


class Message(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The fields that every message has.

    Attributes:
        schema: version of these definitions.
        source: who sent it: the robot's name, or the operator's as it names itself.
        session: random, new at each start of the sender's process.
        seq: counts up by one a message of this kind and session.
        t_sent_ns: sender's monotonic clock; for a command the instant at which its tick began.
        echo: newest message received from the other side.
        check: CRC-32 of the bytes before it; the codec writes it as the last field, verifies it and takes it
            off again, so that a node never sees it. A foreign sender may leave it out.
    """

    schema: int = SCHEMA
    source: Name
    session: Stamp
    seq: Stamp
    t_sent_ns: Stamp
    echo: Echo | None = None
    check: Annotated[int, Meta(ge=0, le=2**32 - 1)] | msgspec.UnsetType = msgspec.UNSET
