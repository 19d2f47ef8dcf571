"""What came of a stream is judged by its arrival alone: in order, in time, from a sender that is not silent.

No two clocks are compared. A sender's stamp says only how much longer a message took than the fastest of that sender,
so that a clock that is wrong by any amount does no harm; what was held up under way is told from what is new.
"""

from dataclasses import dataclass, field

LATE_NS = 100_000_000
"""A message that took so much longer than the fastest of its sender is old."""
FORGETS = 0.01
"""By this share of the time that passes the fastest is forgotten: a clock that was set back is believed again."""
SENDERS = 16
LATE, OVERTAKEN = "late", "overtaken"


@dataclass(slots=True)
class _Sender:
    seq: int
    fastest_ns: int
    heard_ns: int


@dataclass(slots=True)
class Arrivals:
    """The senders of one topic, the last few."""

    _senders: dict[bytes, _Sender] = field(default_factory=dict)

    def judge(self, gid: bytes, seq: int, sent_ns: int, now_ns: int) -> str:
        """Why a message that arrived at `now_ns` counts for nothing; empty: it counts.

        Args:
            gid: its sender.
            seq: its number there.
            sent_ns: when it says that it was sent, on whatever clock.
            now_ns: the instants never go back.
        """
        took_ns = now_ns - sent_ns
        sender = self._senders.pop(gid, None)
        if sender is None:
            self._senders[gid] = _Sender(seq, took_ns, now_ns)
            while len(self._senders) > SENDERS:
                del self._senders[next(iter(self._senders))]
            return ""
        self._senders[gid] = sender
        if seq <= sender.seq:
            return OVERTAKEN
        forgiven_ns = round(FORGETS * (now_ns - sender.heard_ns))
        sender.fastest_ns = min(took_ns, sender.fastest_ns + forgiven_ns)
        sender.seq, sender.heard_ns = seq, now_ns
        return LATE if took_ns - sender.fastest_ns > LATE_NS else ""
