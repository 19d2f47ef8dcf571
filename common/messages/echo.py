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


LEFT_NS = 2_000_000_000
"""Beyond any network's jitter: what a program sent before its restart may come so late."""
REMEMBERED = 8
"""Sessions that were left; bounded, whatever comes."""


class Newest:
    """The newest message, by sequence number, of the other side's newest session.

    Newest by seq and not by arrival: under reordering an echo must not go backwards.

    Args:
        left_ns: for how long (ns) a session that another one followed is not gone back to: what it sent before its
            end may come late.
    """

    def __init__(self, left_ns: int = 0) -> None:
        self._left_ns = left_ns
        self._left: dict[int, int] = {}  # when each session was left
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
            if self._left_ns and not self._leave(message.session, arrived_ns):
                return False
            self.received = 0
        self.session, self.seq = message.session, message.seq
        self.t_sent_ns, self.arrived_ns = message.t_sent_ns, arrived_ns
        self.received += 1
        return True

    def _leave(self, session: int, now_ns: int) -> bool:
        """Go over to another session; False: it was left itself, just now."""
        left = {each: at_ns for each, at_ns in self._left.items() if now_ns - at_ns < self._left_ns}
        if session in left:
            return False
        if self.seq >= 0:
            left[self.session] = now_ns
        self._left = dict(list(left.items())[-REMEMBERED:])
        return True

    def echo(self, now_ns: int) -> Echo | None:
        """The echo to send at `now_ns`; None before anything has arrived."""
        if self.seq < 0:
            return None
        return Echo(self.session, self.seq, self.t_sent_ns, max(0, now_ns - self.arrived_ns))
