"""The joints of a state, read without the rest of it, which nobody needs five hundred times a second."""

import math
from typing import Annotated

import msgspec

from farhand.common.messages.base import SCHEMA, Real, Stamp
from farhand.common.messages.codec import Decoder, is_sealed
from farhand.common.messages.state import MAX_JOINTS, RobotState


class Joints(msgspec.Struct, frozen=True, gc=False):
    """See RobotState, whose fields these are."""

    session: Stamp
    seq: Stamp
    t_sent_ns: Stamp
    check: int
    joints: Annotated[tuple[Real, ...], msgspec.Meta(max_length=MAX_JOINTS)] = ()
    schema: int = SCHEMA


class JointReader:
    """Reads the joints of what its sender has sealed by a CRC; all else is judged as a whole state is.

    Attributes:
        whole: judges those, and counts what it refuses.
    """

    def __init__(self) -> None:
        self.whole = Decoder(RobotState)
        self._decoder = msgspec.msgpack.Decoder(Joints)

    def read(self, payload: bytes) -> Joints | RobotState | None:
        """The joints; None where it is no state."""
        try:
            found = self._decoder.decode(payload)
        except (msgspec.MsgspecError, ValueError, RecursionError, OverflowError):
            return self.whole.decode(payload)
        if (
            found.schema == SCHEMA
            and is_sealed(payload, found.check)
            and math.isfinite(sum(found.joints))  # all are bounded, so that only NaN can spoil the sum
        ):
            return found
        return self.whole.decode(payload)
