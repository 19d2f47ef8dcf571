"""Whether two programs of one name speak under one key: sessions that overlap in time."""

from collections import OrderedDict
from itertools import pairwise

SEEN_WITHIN_NS = 1_000_000_000
REMEMBERED = 8


class Twins:
    """Told of every message's session; memory is bounded.

    A restart is no twin: the old session ends, and what of it is still on the way arrives within the jitter of
    the network. Twins are two sessions of which each was heard in the last second, and the older one for longer than
    `overlap_ns` after the younger one began.

    Args:
        overlap_ns: see above; longer than the network's jitter.
    """

    def __init__(self, overlap_ns: int) -> None:
        self._overlap_ns = overlap_ns
        self._heard: OrderedDict[int, tuple[int, int]] = OrderedDict()  # session: first and last instant

    def note(self, session: int, now_ns: int) -> None:
        """A message of `session` arrived at `now_ns`, on the reader's clock."""
        first, last = self._heard.pop(session, (now_ns, now_ns))
        if now_ns - last > SEEN_WITHIN_NS:
            first = now_ns
        self._heard[session] = first, now_ns
        if len(self._heard) > REMEMBERED:
            self._heard.popitem(last=False)

    def there(self, now_ns: int) -> bool:
        """Whether there are twins at `now_ns`."""
        if len(self._heard) < 2:
            return False
        live = sorted(each for each in self._heard.values() if now_ns - each[1] <= SEEN_WITHIN_NS)
        return any(
            min(older[1], younger[1]) - younger[0] > self._overlap_ns for older, younger in pairwise(live)
        )
