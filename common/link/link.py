"""How bytes move: a link sends packets under a key and hands over what has arrived.

The in-memory link joins two ends in one process; `zenoh_link.py` does the same over a Zenoh session.
"""

from collections import deque
from collections.abc import Callable
from typing import Protocol

import msgspec

from farhand.common.link.delivery import Keep

INBOX_LIMIT = 4096


class Packet(msgspec.Struct):
    """A message on the wire.

    Attributes:
        key: Zenoh key expression without wildcards, e.g. `farhand/ur5/command`.
        payload: the bytes.
        arrived_ns: arrival on the receiver's clock (ns); 0 until it has arrived.
        envelope: transport metadata that a forwarder must copy (opaque to nodes).
        keep: whether each packet of its key counts ("every") or only the newest ("newest"), while it waits
            to be sent; None: as the table in delivery.py says for its key.
    """

    key: str
    payload: bytes
    arrived_ns: int = 0
    envelope: object = None
    keep: Keep | None = None


class Link(Protocol):
    """One end of a connection; neither call ever blocks or raises."""

    def send(self, packet: Packet) -> None:
        """Hand a packet over for sending."""
        ...

    def receive(self) -> list[Packet]:
        """Everything that has arrived since the last call, in order of arrival."""
        ...


class Inbox:
    """A bounded queue of arrived packets, for links in memory: when full, the oldest goes and is counted.

    Appending and draining may happen in different threads.
    """

    def __init__(self, limit: int = INBOX_LIMIT) -> None:
        self._packets: deque[Packet] = deque()
        self._limit = limit
        self.overflowed = 0

    def put(self, packet: Packet) -> None:
        """Append an arrived packet."""
        if len(self._packets) >= self._limit:
            try:
                self._packets.popleft()
                self.overflowed += 1
            except IndexError:
                pass
        self._packets.append(packet)

    def drain(self) -> list[Packet]:
        """Remove and return all packets, oldest first."""
        packets: list[Packet] = []
        if not self._packets:  # most calls by far, in virtual time
            return packets
        try:
            while True:
                packets.append(self._packets.popleft())
        except IndexError:
            return packets


class MemoryLink:
    """One end of an in-memory wire.

    Args:
        transmit: called with every packet sent; it decides when the other end's `deliver` is called.
    """

    def __init__(self, transmit: Callable[["MemoryLink", Packet], None] | None = None) -> None:
        self._transmit = transmit
        self.inbox = Inbox()
        self.peer: MemoryLink | None = None
        self.on_arrival: Callable[[int], None] | None = None

    def send(self, packet: Packet) -> None:
        """Send to the other end, at once unless a `transmit` decides otherwise."""
        if self.peer is None:
            return
        if self._transmit is None:
            self.peer.deliver(packet, packet.arrived_ns)
        else:
            self._transmit(self.peer, packet)

    def deliver(self, packet: Packet, now_ns: int) -> None:
        """Put a copy of the packet into this end's inbox, arrived at `now_ns`."""
        self.inbox.put(Packet(packet.key, packet.payload, now_ns, packet.envelope))
        if self.on_arrival is not None:
            self.on_arrival(now_ns)

    def receive(self) -> list[Packet]:
        """Everything that has arrived since the last call, in order of arrival."""
        return self.inbox.drain()


def memory_wire(
    transmit: Callable[[MemoryLink, Packet], None] | None = None,
) -> tuple[MemoryLink, MemoryLink]:
    """Two joined ends."""
    left, right = MemoryLink(transmit), MemoryLink(transmit)
    left.peer, right.peer = right, left
    return left, right
