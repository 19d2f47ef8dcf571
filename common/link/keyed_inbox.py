"""What has arrived and was not looked at: bounded, and no key pushes out another one."""

import threading
from collections import Counter, deque

from farhand.common.link.delivery import CLASSES, class_of
from farhand.common.link.link import Packet

KEY_LIMIT = 2048
TOTAL_LIMIT = 8192
NEWEST_LIMIT = 256
MAX_KEYS = 256


class KeyedInbox:
    """Packets in order of arrival, with a bound a key and one for all together.

    At its bound a key loses its own oldest packet; where all together are too many, the key that has most
    does. Of classes of which only the newest counts fewer are kept, but not one alone: the last to arrive
    over a network that reorders need not be the newest, nor true; who reads it knows by its number.

    Filled and emptied in different threads.

    Args:
        key_limit: packets a key of which each counts.
        total_limit: packets of all keys.
        newest_limit: packets a key of which only the newest counts.

    Attributes:
        lost: packets that found no place and of which each counts, by class.
        replaced: the same where only the newest counts.
    """

    def __init__(
        self,
        key_limit: int = KEY_LIMIT,
        total_limit: int = TOTAL_LIMIT,
        newest_limit: int = NEWEST_LIMIT,
    ) -> None:
        self.lost: Counter[str] = Counter()
        self.replaced: Counter[str] = Counter()
        self._limits = {"every": key_limit, "newest": newest_limit}
        self._total_limit = total_limit
        self._packets: dict[int, Packet] = {}
        self._numbers: dict[str, deque[int]] = {}
        self._count = 0
        self._lock = threading.Lock()

    @property
    def overflowed(self) -> int:
        """All packets that found no place."""
        return sum(self.lost.values()) + sum(self.replaced.values())

    def put(self, packet: Packet) -> None:
        """Append an arrived packet."""
        limit = self._limits[CLASSES[class_of(packet.key)].keep]
        with self._lock:
            # The 257th key and all further ones share a queue: a stranger may invent as many as it likes.
            known = packet.key in self._numbers or len(self._numbers) < MAX_KEYS
            mine = self._numbers.setdefault(packet.key if known else "", deque())
            if len(mine) >= limit:
                self._drop(mine)
            elif len(self._packets) >= self._total_limit:
                self._drop(max(self._numbers.values(), key=len))
            self._packets[self._count] = packet
            mine.append(self._count)
            self._count += 1

    def drain(self) -> list[Packet]:
        """Remove and return all packets, in order of arrival."""
        if not self._packets:
            return []
        with self._lock:
            packets, self._packets, self._numbers = self._packets, {}, {}
        return list(packets.values())

    def _drop(self, numbers: "deque[int]") -> None:
        packet = self._packets.pop(numbers.popleft())
        name = class_of(packet.key)
        (self.lost if CLASSES[name].keep == "every" else self.replaced)[name] += 1
