"""What waits for its release: a heap of (release time, sequence), bounded in messages and bytes."""

import heapq

import msgspec

from farhand.netem.impairments.base import Transit


class Limits(msgspec.Struct, frozen=True):
    """Bounds of the memory of one direction.

    Attributes:
        messages: that may wait.
        size: bytes of payload that may wait.
    """

    messages: int = 50_000
    size: int = 128_000_000


class ReleaseQueue:
    """Messages in order of release; those of the same instant in order of arrival.

    Args:
        limits: beyond these nothing is taken.
    """

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._heap: list[tuple[int, int, Transit]] = []
        self._sequence = 0
        self.size = 0

    def __len__(self) -> int:
        return len(self._heap)

    def push(self, transit: Transit) -> bool:
        """Take a message; False when the limits do not allow it."""
        if len(self._heap) >= self._limits.messages or self.size + transit.size > self._limits.size:
            return False
        heapq.heappush(self._heap, (transit.release_ns, self._sequence, transit))
        self._sequence += 1
        self.size += transit.size
        return True

    def pop_due(self, now_ns: int) -> Transit | None:
        """The next message whose release time has come; None if there is none."""
        if not self._heap or self._heap[0][0] > now_ns:
            return None
        transit = heapq.heappop(self._heap)[2]
        self.size -= transit.size
        return transit

    def next_ns(self) -> int | None:
        """When the next message is due."""
        return self._heap[0][0] if self._heap else None

    def waiting(self) -> list[Transit]:
        """What is in it, in the order in which it is due."""
        return [transit for _, _, transit in sorted(self._heap, key=lambda entry: entry[:2])]
