"""The control lease: one operator session at a time may move the robot, and the robot says which.

It is taken when it is free, passed on when its holder says to whom, and ends when its holder gives it up or
falls silent. Whoever asks while another one holds it is remembered for a while, to be shown and handed over to.
"""

from collections import OrderedDict
from dataclasses import dataclass

from farhand.common.messages.state import MAX_WAITING, LeaseEnd

ASKED_NS = 3_000_000_000  # who has not asked for longer than this waits no more


@dataclass(frozen=True, slots=True)
class _Asker:
    """Attributes:
    name: as it named itself.
    seq: of its newest request.
    heard_ns: when that came.
    """

    name: str
    seq: int
    heard_ns: int


class ControlLease:
    """Who holds control and who waits for it, on the robot's own clock.

    Args:
        timeout_ns: a holder that is silent for longer loses control.

    Attributes:
        holder: its session; 0: nobody.
        holder_name: as it named itself; empty: nobody.
        end: how the last lease ended; empty while there was none.
        since_ns: when control last became free or was handed over. What was decided on an earlier state of
            the robot was decided by somebody who did not know.
    """

    def __init__(self, timeout_ns: int) -> None:
        self._timeout_ns = timeout_ns
        self._heard_ns = 0
        self._askers: OrderedDict[int, _Asker] = OrderedDict()
        self.holder = 0
        self.holder_name = ""
        self.end: LeaseEnd = ""
        self.since_ns = 0

    def grant(self, session: int, name: str, now_ns: int) -> bool:
        """Give control to `session`, or note that it was heard, unless another one has it; whether it has it."""
        if self.holder not in (0, session):
            return False
        if self.holder == 0:
            self._askers.pop(session, None)
            self.holder, self.holder_name = session, name
        self._heard_ns = now_ns
        return True

    def ask(self, session: int, name: str, seq: int, now_ns: int) -> bool:
        """Remember who asks for control while another one holds it; False if the request is an old one."""
        known = self._askers.get(session)
        if known is not None and seq <= known.seq:
            return False
        self._askers[session] = _Asker(name, seq, now_ns)
        self._askers.move_to_end(session)
        if len(self._askers) > MAX_WAITING:
            self._askers.popitem(last=False)
        return True

    def waiting(self, now_ns: int) -> tuple[tuple[int, str], ...]:
        """Sessions and names of those who have asked lately, the newest request last."""
        if not self._askers:
            return ()
        return tuple(
            (session, asker.name) for session, asker in self._askers.items() if self.waits(session, now_ns)
        )

    def waits(self, session: int, now_ns: int) -> bool:
        """Whether a session has asked lately."""
        asker = self._askers.get(session)
        return asker is not None and now_ns - asker.heard_ns <= ASKED_NS

    def hand_over(self, successor: int, now_ns: int) -> None:
        """Pass control to a session that waits.

        The successor has the timeout to be heard from; nobody else can take control meanwhile.
        """
        self.holder, self.holder_name = successor, self._askers.pop(successor).name
        self._heard_ns = self.since_ns = now_ns

    def release(self, now_ns: int) -> None:
        """The holder gives control up."""
        self._end("released", now_ns)

    def expire(self, now_ns: int) -> bool:
        """End the lease of a holder that has been silent for too long; whether that happened now."""
        if self.holder == 0 or now_ns - self._heard_ns <= self._timeout_ns:
            return False
        self._end("silent", now_ns)
        return True

    def _end(self, how: LeaseEnd, now_ns: int) -> None:
        self.holder, self.holder_name, self.end, self.since_ns = 0, "", how, now_ns
