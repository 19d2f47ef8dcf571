"""Lines for people about what may happen ten thousand times a second."""

from collections import Counter
from collections.abc import Callable

from farhand.common.timing.clock import to_ns

SAY_AGAIN_AFTER = 10.0
"""A kind of thing is said at once, then as a count at most this often (s)."""
MAX_KINDS = 64


class RareLines:
    """Says the first of each kind, then only how many more there were.

    Args:
        say: takes a line for people.
        again: how long after a line of a kind the next one of it comes at the earliest (s).
    """

    def __init__(self, say: Callable[[str], None], again: float = SAY_AGAIN_AFTER) -> None:
        self._say, self._again_ns = say, to_ns(again)
        self._texts: dict[str, str] = {}
        self._unsaid: Counter[str] = Counter()
        self._said_ns: dict[str, int] = {}

    def note(self, kind: str, text: str, now_ns: int, count: int = 1) -> None:
        """`count` things of a kind happened; `text` describes the newest."""
        if kind not in self._said_ns and len(self._said_ns) >= MAX_KINDS:
            kind, text = "", "and other things, too many to tell apart"
        self._texts[kind] = text
        if kind not in self._said_ns:
            self._said_ns[kind] = now_ns
            self._say(text)
            count -= 1
        if count > 0:
            self._unsaid[kind] += count
            self.tick(now_ns)

    def tick(self, now_ns: int) -> None:
        """Let time act: say the counts that have waited long enough."""
        for kind, count in list(self._unsaid.items()):
            if now_ns - self._said_ns[kind] >= self._again_ns:
                del self._unsaid[kind]
                self._said_ns[kind] = now_ns
                self._say(f"{self._texts[kind]} ({count} more)")
