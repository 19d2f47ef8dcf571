"""The newest ticks of an operator's node, for a recorder that comes for them."""

from dataclasses import dataclass

from farhand.common.link.link import Packet
from farhand.common.messages.codec import encode
from farhand.common.messages.report import ControlReport
from farhand.common.recording.batch import BATCH_BYTES
from farhand.common.recording.history import History
from farhand.common.recording.records import TickRecord

KEPT = 3000
"""Ticks: five minutes at 10 Hz, one at 50 Hz, some 15 MB at most."""


@dataclass(frozen=True, slots=True)
class _Tick:
    """As the loop hands it over: encoded only when somebody asks for it."""

    now_ns: int
    packets: tuple[Packet, ...]
    command: bytes | None
    report: ControlReport

    def record(self, number: int) -> TickRecord:
        copies = tuple((p.key, p.arrived_ns, p.payload) for p in self.packets)
        return TickRecord(number, self.now_ns, copies, self.command, encode(self.report))


class TickHistory:
    """Args:
    kept: how many ticks.
    """

    def __init__(self, kept: int = KEPT) -> None:
        self._ticks: History[_Tick] = History(kept)

    def tick(self, now_ns: int, packets: list[Packet], command: bytes | None, report: ControlReport) -> None:
        """Keep one tick; for the loop's thread."""
        self._ticks.add(_Tick(now_ns, tuple(packets), command, report))

    def since(self, number: int, size: int = BATCH_BYTES) -> tuple[tuple[TickRecord, ...], bool]:
        """Ticks from a number on, and whether there are more; for any thread.

        The first may have a higher number: what was before it is kept no more.
        """
        first, ticks, count = self._ticks.since(number, size, _size)
        records = tuple(tick.record(first + i) for i, tick in enumerate(ticks))
        return records, first + len(records) < count


def _size(tick: _Tick) -> int:
    return 1000 + sum(len(packet.payload) for packet in tick.packets)
