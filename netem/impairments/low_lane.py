"""What a link of a given rate has left for messages of low priority: they are sent while nothing else is.

Strict priority, preemptive and without loss: a message of low priority that is being sent stops as soon as another one
arrives, and goes on behind it, as the fragments of a large one do in a scheduler that knows priorities. Of those
that wait only the newest is kept. When one is done is known only once nothing can come between any more, so that
its release is foretold, looked at again when its time has come, and put off by what came between.
"""

from collections import deque

from farhand.netem.impairments.base import Pending, Transit

LOW_CLASSES = frozenset({"camera"})
"""Classes of messages that give way to all others."""
SUPERSEDED = "superseded"
"""Why a message was dropped in whose place a newer one waits."""


class LowLane:
    """One link's low lane; all instants in ns."""

    def __init__(self) -> None:
        self._busy: deque[tuple[int, int]] = deque()
        self._at = 0
        self._sending: _Low | None = None
        self._waiting: _Low | None = None

    def occupied(self, start_ns: int, end_ns: int) -> None:
        """The link sends something else from `start_ns` to `end_ns`, which is not before the last such interval."""
        if self._sending is None and self._busy and self._busy[-1][1] < start_ns:
            self._busy.clear()  # nobody asks for it any more
        if self._busy and self._busy[-1][1] == start_ns:
            start_ns = self._busy.pop()[0]
        self._busy.append((start_ns, end_ns))

    def join(self, transit: Transit, duration_ns: int) -> None:
        """Take a message that needs the link for `duration_ns`; its release is when it is done, as far as known."""
        self.advance(transit.release_ns)
        low = _Low(transit, duration_ns)
        if self._sending is None:
            self._at = max(self._at, transit.release_ns)
            self._sending = low
        else:
            if self._waiting is not None:
                self._waiting.transit.cause = SUPERSEDED
            self._waiting = low
        low.foretold_ns = self._foretell(low)
        transit.release_ns = low.foretold_ns
        transit.pending = Pending(lambda now_ns: self._put_off(low, now_ns))

    def advance(self, to_ns: int) -> None:
        """Send what can be sent until `to_ns`."""
        while self._sending is not None and self._at < to_ns:
            while self._busy and self._busy[0][1] <= self._at:
                self._busy.popleft()
            if self._busy and self._busy[0][0] <= self._at:
                self._at = min(to_ns, self._busy[0][1])
                continue
            until_ns = min(to_ns, self._busy[0][0]) if self._busy else to_ns
            if self._at + self._sending.left_ns > until_ns:
                self._sending.left_ns -= until_ns - self._at
                self._at = until_ns
                continue
            self._at += self._sending.left_ns
            self._sending.left_ns, self._sending.done_ns = 0, self._at
            self._sending, self._waiting = self._waiting, None

    def _put_off(self, low: "_Low", now_ns: int) -> bool:
        """Whether a message whose foretold time has come must wait on; moves its release then."""
        if low.transit.cause:
            return False
        self.advance(now_ns)
        foretold_ns = self._foretell(low) if low.done_ns is None else low.done_ns
        later_ns, low.foretold_ns = foretold_ns - low.foretold_ns, foretold_ns
        if later_ns <= 0:
            return False
        low.transit.release_ns += later_ns
        return True

    def _foretell(self, low: "_Low") -> int:
        """When a message is done, if nothing more comes."""
        assert self._sending is not None
        needed_ns = self._sending.left_ns + (low.left_ns if low is not self._sending else 0)
        at_ns = self._at
        for start_ns, end_ns in self._busy:
            if end_ns <= at_ns:
                continue
            if at_ns + needed_ns <= start_ns:
                break
            needed_ns -= max(0, start_ns - at_ns)
            at_ns = end_ns
        return at_ns + needed_ns


class _Low:
    """A message of the low lane, for how long it still needs the link, and when it was, or will be, done."""

    __slots__ = ("done_ns", "foretold_ns", "left_ns", "transit")

    def __init__(self, transit: Transit, left_ns: int) -> None:
        self.transit, self.left_ns = transit, left_ns
        self.foretold_ns = 0
        self.done_ns: int | None = None
