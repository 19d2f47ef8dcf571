"""The newest ticks of an operator's node, kept for a recorder that comes for them: its loop waits for nobody."""

from collections import deque
from dataclasses import dataclass

from farhand.common.link.link import Packet
from farhand.common.messages.codec import encode
from farhand.common.messages.report import ControlReport
from farhand.common.recording.records import TickRecord

KEPT = 3000
"""Ticks: five minutes at 10 Hz, one at 50 Hz, some 15 MB at most."""


@dataclass(frozen=True, slots=True)
class _Tick:
    """As the loop hands it over: encoded only when somebody asks for it."""

    number: int
    now_ns: int
    packets: tuple[Packet, ...]
    command: bytes | None
    report: ControlReport

    def record(self) -> TickRecord:
        copies = tuple((p.key, p.arrived_ns, p.payload) for p in self.packets)
        return TickRecord(self.number, self.now_ns, copies, self.command, encode(self.report))


class TickHistory:
    """Args:
    kept: how many ticks.

    Attributes:
        taken: number of the first tick that nobody has come for yet.
    """

    def __init__(self, kept: int = KEPT) -> None:
        self.taken = 0
        self._ticks: deque[_Tick] = deque(maxlen=kept)
        self._count = 0

    def tick(self, now_ns: int, packets: list[Packet], command: bytes | None, report: ControlReport) -> None:
        """Keep one tick; for the loop's thread."""
        self._ticks.append(_Tick(self._count, now_ns, tuple(packets), command, report))
        self._count += 1

    def since(self, number: int, size: int) -> tuple[TickRecord, ...]:
        """Ticks from a number on, the oldest first, until they have so many bytes; for any thread.

        The first may have a higher number: what was before it is kept no more.
        """
        found: list[TickRecord] = []
        for tick in self._snapshot():
            if tick.number < number:
                continue
            record = tick.record()
            size -= len(record.report) + sum(len(payload) for _, _, payload in record.packets)
            found.append(record)
            if size <= 0:
                break
        self.taken = found[-1].number + 1 if found else max(self.taken, min(number, self._count))
        return tuple(found)

    @property
    def more(self) -> bool:
        """Whether there are ticks that nobody has come for."""
        return self.taken < self._count

    def _snapshot(self) -> list[_Tick]:
        while True:
            try:
                return list(self._ticks)
            except RuntimeError:  # the loop added one at that very moment
                continue
