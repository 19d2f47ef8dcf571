"""Sequence numbers and echoes: the book-keeping of one side of a conversation."""

from typing import Protocol

from farhand.common.messages.base import Echo


class Numbered(Protocol):
    """What has a message's number: a message, or some of its fields."""

    @property
    def session(self) -> int:
        """See Message."""
        ...

    @property
    def seq(self) -> int:
        """See Message."""
        ...

    @property
    def t_sent_ns(self) -> int:
        """See Message."""
        ...


class Newest:
    """The newest message, by sequence number, of the other side's newest session.

    Newest by seq and not by arrival: under reordering an echo must not go backwards.
    """

    def __init__(self) -> None:
        self.session = 0
        self.seq = -1
        self.t_sent_ns = 0
        self.arrived_ns = 0
        self.received = 0

    def accept(self, message: Numbered, arrived_ns: int) -> bool:
        """Note a message; False when a newer one of the same session was already there."""
        if message.session == self.session and message.seq <= self.seq:
            return False
        if message.session != self.session:
            self.received = 0
        self.session, self.seq = message.session, message.seq
        self.t_sent_ns, self.arrived_ns = message.t_sent_ns, arrived_ns
        self.received += 1
        return True

    def echo(self, now_ns: int) -> Echo | None:
        """The echo to send at `now_ns`; None before anything has arrived."""
        if self.seq < 0:
            return None
        return Echo(self.session, self.seq, self.t_sent_ns, max(0, now_ns - self.arrived_ns))
