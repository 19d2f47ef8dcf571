"""Who hears the messages of a simulation beside its nodes: a hash of all, and a tap on the way back."""

from collections.abc import Callable
from typing import Protocol

from farhand.common.link.link import MemoryLink, Packet


class Tap(Protocol):
    """Who listens on both ends of the way back."""

    def robot_sent(self, packet: Packet) -> None:
        """A packet that leaves the robot."""

    def operator_got(self, packet: Packet, now_ns: int) -> None:
        """A packet that has reached the operator, at `now_ns`."""


def hash_traffic(end: MemoryLink, update: Callable[[bytes], None]) -> None:
    """Feed every packet that leaves or reaches this end to a hash, with its stamp."""
    send, deliver = end.send, end.deliver

    def hashed_send(packet: Packet) -> None:
        update(b">" + packet.key.encode() + packet.payload)
        send(packet)

    def hashed_deliver(packet: Packet, now_ns: int) -> None:
        update(b"<%d" % now_ns + packet.key.encode() + packet.payload)
        deliver(packet, now_ns)

    end.send, end.deliver = hashed_send, hashed_deliver  # type: ignore[method-assign]


def listen(operator_end: MemoryLink, robot_end: MemoryLink, tap: Tap) -> None:
    """Give every packet of the way back to a tap as well, at both ends."""
    send, deliver = robot_end.send, operator_end.deliver

    def heard_send(packet: Packet) -> None:
        tap.robot_sent(packet)
        send(packet)

    def heard_deliver(packet: Packet, now_ns: int) -> None:
        tap.operator_got(packet, now_ns)
        deliver(packet, now_ns)

    robot_end.send, operator_end.deliver = heard_send, heard_deliver  # type: ignore[method-assign]
