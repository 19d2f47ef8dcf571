"""What comes from ROS, read and judged: each refusal is counted by its reason, and said once in a while."""

import math
from collections import Counter
from collections.abc import Callable, Iterable
from typing import Any

from farhand.bridges.ros2.cdr.twists import TWIST, StampedTwist, read_twist
from farhand.bridges.ros2.cdr.types import CdrError, Types
from farhand.bridges.ros2.graph.node import Heard
from farhand.bridges.ros2.graph.wire import Attachment, dds_name, read_attachment
from farhand.bridges.ros2.inbound.twist_hand import Wanted
from farhand.common.errors import FarhandError
from farhand.common.messages.steering import Frame
from farhand.common.trust.rare_lines import RareLines

JOY = "sensor_msgs/msg/Joy"
MAX_INPUTS = 64
FAST = 1e3
"""Nothing that moves is asked for so fast (m/s, rad/s)."""


class RefusedError(FarhandError):
    """A message counts for nothing.

    Attributes:
        reason: one or two words.
        attachment: its sender's, where that could be read.
    """

    def __init__(self, reason: str, detail: str, attachment: Attachment | None = None) -> None:
        super().__init__(f"{reason}: {detail}")
        self.reason, self.attachment = reason, attachment


class Reader:
    """Args:
    types: of the distribution.
    kind: what it takes.
    key: under which that comes.
    """

    def __init__(self, types: Types, kind: str, key: str) -> None:
        self._types, self._kind, self._key = types, kind, key

    def read(self, heard: Heard) -> tuple[Attachment, Any]:
        """Attachment and message; raises RefusedError."""
        if heard.key != self._key:
            self._refuse_key(heard.key)
        attachment = read_attachment(heard.attachment)
        if attachment is None:
            size = "none" if heard.attachment is None else f"one of {len(heard.attachment)} bytes"
            raise RefusedError("attachment", f"{size}; rmw_zenoh's has 33")
        try:
            message: Any = (
                read_twist(heard.payload, self._types)
                if self._kind == TWIST
                else self._types.decode(heard.payload, self._kind)
            )
        except CdrError as error:
            raise RefusedError("malformed", str(error), attachment) from None
        return attachment, message

    def _refuse_key(self, key: str) -> None:
        domain, *_, kind, type_hash = key.split("/")
        own = self._key.split("/")
        if domain != own[0]:
            raise RefusedError("domain", f"{domain[:16]}; this node is of domain {own[0]}")
        if kind != own[-2]:
            raise RefusedError("type", f"{kind[:80]}; expected {dds_name(self._kind)}")
        raise RefusedError("type hash", f"{type_hash[:80]}; expected {own[-1]}: another distribution?")


class TwistFrames:
    """Args:
    base, tool: what the two frames are called.
    """

    def __init__(self, base: str, tool: str) -> None:
        self._frames: dict[str, Frame] = {base: "base", tool: "tool"}

    def wanted(self, message: StampedTwist, attachment: Attachment) -> Wanted:
        """What a TwistStamped wants; raises RefusedError."""
        frame = self._frames.get(message.frame_id)
        if frame is None:
            known = " or ".join(repr(name) for name in self._frames)
            raise RefusedError("frame", f"{message.frame_id[:64]!r}; expected {known}", attachment)
        _, linear, angular = message
        if not _finite((*linear, *angular)):
            raise RefusedError("not finite", "a part of the twist is", attachment)
        return Wanted(linear, angular, frame)


def inputs_of(message: Any, attachment: Attachment) -> dict[str, float]:
    """Axes and buttons of a Joy by name: `axis0`, `button0`; raises RefusedError."""
    axes, buttons = [float(each) for each in message.axes], [float(each) for each in message.buttons]
    if len(axes) + len(buttons) > MAX_INPUTS:
        raise RefusedError("too many", f"{len(axes)} axes and {len(buttons)} buttons", attachment)
    if not all(math.isfinite(each) and abs(each) <= 1.0 for each in axes):
        raise RefusedError("not finite", "an axis is not from -1 to 1", attachment)
    if not all(each in (0.0, 1.0) for each in buttons):
        raise RefusedError("malformed", "a button is neither 0 nor 1", attachment)
    found = {f"axis{n}": value for n, value in enumerate(axes)}
    return found | {f"button{n}": value for n, value in enumerate(buttons)}


class Refusals:
    """Args:
    tell: takes a line for people; must not wait.

    Attributes:
        counts: by topic and reason.
    """

    def __init__(self, tell: Callable[[str], None]) -> None:
        self.counts: Counter[str] = Counter()
        self._lines = RareLines(tell)

    def add(self, topic: str, reason: str, words: str, now_ns: int) -> None:
        """Count one, and have it said once in a while."""
        kind = f"{topic}: {reason}"
        self.counts[kind] += 1
        self._lines.note(kind, f"{topic}: refused: {words}", now_ns)


def _finite(values: Iterable[float]) -> bool:
    return all(math.isfinite(value) and abs(value) < FAST for value in values)
