"""What pages say, a MessagePack map each; whatever else comes is refused."""

from typing import Annotated, Literal

import msgspec
from msgspec import Meta, Struct

from farhand.common.errors import FarhandError
from farhand.common.messages.steering import Frame, Share

MAX_BYTES = 4096
Axis = Annotated[float, Meta(ge=-1, le=1)]
Axes = tuple[Axis, Axis, Axis]
Unit = Annotated[float, Meta(ge=-1.001, le=1.001)]
Number = Annotated[int, Meta(ge=0, le=2**53)]
Milliseconds = Annotated[float, Meta(ge=0, le=1e12)]
Deed = Literal["estop", "acknowledge", "take", "release", "give"]


class SaidError(FarhandError):
    """What a page said is no message."""


class Hello(Struct, frozen=True, forbid_unknown_fields=True, tag_field="kind", tag="hello"):
    """The first message.

    Attributes:
        page: what the page was built from.
        token: empty where none is needed.
    """

    page: Annotated[str, Meta(max_length=128)]
    token: Annotated[str, Meta(max_length=256)] = ""


class Steer(Struct, frozen=True, forbid_unknown_fields=True, tag_field="kind", tag="steer"):
    """What the hand wants, 50 times a second while something is held down, else now and then.

    Attributes:
        n: order number, of all that the page says.
        t: the page's clock (ms).
        engaged, press: see common/messages/steering.py.
        linear, angular: shares -1..1, along the axes of `frame`.
        view: orientation of the view in base (w, x, y, z).
        scale: what both are multiplied by.
        seen: the `stamp` of the newest frame that the page has; None: not said.
    """

    n: Number
    t: Milliseconds
    engaged: bool
    press: Number
    linear: Axes = (0.0, 0.0, 0.0)
    angular: Axes = (0.0, 0.0, 0.0)
    frame: Frame = "base"
    view: tuple[Unit, Unit, Unit, Unit] = (1.0, 0.0, 0.0, 0.0)
    scale: Share = 1.0
    seen: Number | None = None


class Do(Struct, frozen=True, forbid_unknown_fields=True, tag_field="kind", tag="do"):
    """A button that is pressed, not held.

    Attributes:
        n: as in Steer.
        what: `give` hands the wheel over.
        to: number of the page that gets it.
    """

    n: Number
    what: Deed
    to: Number = 0


class Pictured(Struct, frozen=True, forbid_unknown_fields=True, tag_field="kind", tag="pictured"):
    """A camera's picture has come; only then is the next one sent, so that none waits on the way to a slow page."""


class ChooseNetwork(Struct, frozen=True, forbid_unknown_fields=True, tag_field="kind", tag="network"):
    """Change the emulated network.

    Attributes:
        n: as in Steer.
        name: one of those that are offered.
    """

    n: Number
    name: Annotated[str, Meta(max_length=256)]


class CutNetwork(Struct, frozen=True, forbid_unknown_fields=True, tag_field="kind", tag="outage"):
    """Have no network for a while.

    Attributes:
        n: as in Steer.
        seconds: how long (s).
    """

    n: Number
    seconds: Annotated[float, Meta(ge=1, le=5)]


Ordered = Steer | Do | ChooseNetwork | CutNetwork
"""What counts in its order only."""
Said = Hello | Steer | Do | ChooseNetwork | CutNetwork | Pictured
_decoder: msgspec.msgpack.Decoder[Said] = msgspec.msgpack.Decoder(Said)


def read_said(payload: bytes) -> Said:
    """The message; raises SaidError."""
    if len(payload) > MAX_BYTES:
        raise SaidError(f"{len(payload)} bytes; at most {MAX_BYTES}")
    try:
        said: Said = _decoder.decode(payload)
    except (msgspec.DecodeError, ValueError, RecursionError, OverflowError) as error:
        said_badly = repr(str(error)[:200])[
            1:-1
        ]  # it holds names out of the message itself, which may be any letters
        raise SaidError(f"no message of a page: {said_badly}") from None
    return said
