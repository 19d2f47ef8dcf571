"""`tcp-like[:TIMEOUT]`: lost messages come back after a retransmission time, and everything is in order.

The losses and outages of the chain become retransmissions after TIMEOUT (200 ms unless said), doubling at
each further loss of the same message; after 15 it is given up. All messages of the direction wait for those
before them, which is TCP's head-of-line blocking; what was lost behind such a message follows right after it,
so that an outage ends in one burst. tc-netem has it by delaying real TCP packets.
"""

from collections.abc import Sequence
from typing import ClassVar

from farhand.netem.impairments.base import Connection, Impairment, LossModel, Stage, Transit, Word
from farhand.netem.words.reader import SpecReader, milliseconds_text

DEFAULT_TIMEOUT_NS = 200_000_000
MAX_RETRANSMISSIONS = 15
LARGEST_TIMEOUT_NS = 120_000_000_000


class TcpLike(Word, frozen=True):
    """Retransmission and head-of-line blocking.

    Attributes:
        timeout_ns: before the first retransmission.
    """

    timeout_ns: int = DEFAULT_TIMEOUT_NS
    name: ClassVar[str] = "tcp-like"
    example: ClassVar[str] = "tcp-like or tcp-like:200"
    description: ClassVar[str] = "what is lost comes back after a retransmission time, in order"
    kind: ClassVar[str] = "tcp-like"
    stage: ClassVar[Stage] = Stage.TCP
    repairs: ClassVar[bool] = True

    @classmethod
    def parse(cls, reader: SpecReader) -> "TcpLike":
        """`[:TIMEOUT]`, ms."""
        if not reader.take(":"):
            return cls()
        start = reader.position
        timeout_ns = reader.duration_ns("the retransmission timeout in ms")
        if timeout_ns < 1_000_000:
            reader.fail("the retransmission timeout must be at least 1 ms", start)
        return cls(timeout_ns)

    def text(self) -> str:
        """Canonical word."""
        tail = "" if self.timeout_ns == DEFAULT_TIMEOUT_NS else f":{milliseconds_text(self.timeout_ns)}"
        return f"tcp-like{tail}"

    def around(self, losses: Sequence[LossModel], connection: Connection) -> Impairment:
        """What sends again what the losses lose."""
        return _Retransmission(self.timeout_ns, losses, connection)


class _Retransmission(Impairment):
    def __init__(self, timeout_ns: int, losses: Sequence[LossModel], connection: Connection) -> None:
        self._timeout_ns = timeout_ns
        self._losses = losses
        self._connection = connection

    def apply(self, transit: Transit) -> None:
        timeout_ns = self._timeout_ns
        # All models are asked at every transmission, so that each draws the same number of times.
        while True in [model.loses(transit, transit.release_ns) for model in self._losses]:
            if transit.retransmissions == MAX_RETRANSMISSIONS:
                transit.cause = transit.cause or "tcp-like"
                return
            transit.retransmissions += 1
            if transit.release_ns < self._connection.sent_ns:
                transit.release_ns = self._connection.sent_ns
                continue
            transit.release_ns += timeout_ns
            timeout_ns = min(2 * timeout_ns, LARGEST_TIMEOUT_NS)
        self._connection.sent_ns = max(self._connection.sent_ns, transit.release_ns)
