"""What waits to be published: a queue a key, so that no key pushes out or holds up another one."""

import threading
from collections import Counter, deque

from farhand.common.link.delivery import CLASSES, class_of
from farhand.common.link.link import Packet

KEY_LIMIT = 256
MAX_KEYS = 256


class Outbox:
    """Bounded queues a key, emptied in turn: one packet of each key, then the next round.

    Of `newest` packets one waits, and the next takes its place. Of `every` packets the oldest goes when
    `limit` of a key are waiting. The queue of a key is there only while something waits in it.

    Args:
        limit: packets a key that may wait.
        max_keys: keys of which something may wait; a packet of one more is lost, not one of the others.

    Attributes:
        dropped: lost packets of which each counts, by class.
        replaced: packets that gave way to a newer one of their key, by class.
    """

    def __init__(self, limit: int = KEY_LIMIT, max_keys: int = MAX_KEYS) -> None:
        self.dropped: Counter[str] = Counter()
        self.replaced: Counter[str] = Counter()
        self._limit, self._max_keys = limit, max_keys
        self._queues: dict[str, deque[Packet]] = {}
        self._turns: deque[str] = deque()
        self._condition = threading.Condition()
        self._closed = False

    def put(self, packet: Packet) -> None:
        """Queue a packet."""
        with self._condition:
            self._append(packet)
            self._condition.notify()

    def pop(self) -> Packet | None:
        """The next packet, waited for; None once the box is closed and empty."""
        with self._condition:
            while not self._turns and not self._closed:
                self._condition.wait()
            if not self._turns:
                return None
            key = self._turns.popleft()
            waiting = self._queues[key]
            packet = waiting.popleft()
            if waiting:
                self._turns.append(key)
            else:
                del self._queues[key]
            return packet

    def close(self) -> None:
        """Let `pop` return None as soon as nothing waits."""
        with self._condition:
            self._closed = True
            self._condition.notify()

    def _append(self, packet: Packet) -> None:
        waiting = self._queues.get(packet.key)
        if waiting is None:
            if len(self._queues) >= self._max_keys:
                self.dropped[class_of(packet.key)] += 1
                return
            self._queues[packet.key] = deque((packet,))
            self._turns.append(packet.key)
            return
        if keep_of(packet) == "newest" and keep_of(waiting[-1]) == "newest":
            waiting[-1] = packet
            self.replaced[class_of(packet.key)] += 1
            return
        if len(waiting) >= self._limit:
            waiting.popleft()
            self.dropped[class_of(packet.key)] += 1
        waiting.append(packet)


def keep_of(packet: Packet) -> str:
    """What a packet says of itself, or else what the table says of its class."""
    return packet.keep or CLASSES[class_of(packet.key)].keep
