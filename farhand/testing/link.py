"""A link whose other end is the test: it records what is sent, and delivers what it is fed when it is due."""

import heapq
from collections.abc import Callable
from typing import Any

from farhand.common.link.link import Packet
from farhand.common.messages.base import Message
from farhand.common.messages.codec import Decoder, encode
from farhand.common.messages.command import VelocityCommand
from farhand.common.messages.description import RobotDescription
from farhand.common.messages.keys import (
    command_key,
    description_key,
    kind_of,
    report_key,
    scene_key,
    scene_request_key,
    state_key,
)
from farhand.common.messages.report import ControlReport
from farhand.common.messages.scene import Scene
from farhand.common.messages.scene_request import SceneRequest
from farhand.common.messages.state import RobotState

KINDS: dict[str, type[Message]] = {
    "command": VelocityCommand,
    "state": RobotState,
    "scene": Scene,
    "description": RobotDescription,
    "report": ControlReport,
    "scene_request": SceneRequest,
}
KEYS = {
    VelocityCommand: command_key,
    RobotState: state_key,
    Scene: scene_key,
    RobotDescription: description_key,
    ControlReport: report_key,
    SceneRequest: scene_request_key,
}


class ScriptedLink:
    """One end of a connection; the node under test has it, the test is all the rest of the world.

    Args:
        robot: whose keys messages are fed under.
        on_send: called with each packet that is sent; may feed an answer.

    Attributes:
        now_ns: what is fed is delivered once this has reached its instant; assign to it, never backwards.
        sent: every packet that was sent, in order.
    """

    def __init__(self, robot: str = "r", on_send: Callable[[Packet], None] | None = None) -> None:
        self.robot = robot
        self.now_ns = 0
        self.sent: list[Packet] = []
        self._on_send = on_send
        self._fresh: list[Packet] = []
        self._fed = 0
        self._due: list[tuple[int, int, Packet]] = []
        self._decoders = {kind: Decoder(message) for kind, message in KINDS.items()}

    def send(self, packet: Packet) -> None:
        """Record the packet."""
        self.sent.append(packet)
        self._fresh.append(packet)
        if self._on_send is not None:
            self._on_send(packet)

    def receive(self) -> list[Packet]:
        """What was fed and is due at `now_ns`, by instant, then in the order of feeding."""
        packets = []
        while self._due and self._due[0][0] <= self.now_ns:
            packets.append(heapq.heappop(self._due)[2])
        return packets

    def feed(self, what: Message | bytes, at_ns: int | None = None, key: str = "") -> None:
        """Let something arrive.

        Args:
            what: a message, or bytes as they come.
            at_ns: its arrival on the node's clock (ns); None: `now_ns`.
            key: under which it comes; empty: the one of the message's kind. Bytes need one.
        """
        arrived_ns = self.now_ns if at_ns is None else at_ns
        if isinstance(what, Message):
            key = key or KEYS[type(what)](self.robot)
            what = encode(what)
        if not key:
            raise ValueError("bytes are of no kind: say under which key they come")
        self._fed += 1
        heapq.heappush(self._due, (arrived_ns, self._fed, Packet(key, what, arrived_ns)))

    def take(self, kind: str = "") -> list[Any]:
        """Messages sent and not yet taken, decoded; with `kind` (command, state, ...) those alone.

        Raises CodecError for what no receiver would accept, KeyError for a key that is none of Farhand's.
        """
        taken = [packet for packet in self._fresh if kind in ("", kind_of(packet.key))]
        self._fresh = [packet for packet in self._fresh if kind not in ("", kind_of(packet.key))]
        return [self._decoders[kind_of(p.key)].decode_or_raise(p.payload) for p in taken]
