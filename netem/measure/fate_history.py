"""The newest fates, for a recorder that comes for them."""

from farhand.common.recording.fates import Fate
from farhand.common.recording.history import History

KEPT = 200_000
"""Half an hour of one robot at 100 Hz; some 60 MB at most."""
BATCH_BYTES = 1 << 20
FATE_BYTES = 150


class FateHistory:
    """A log (see MessageLog) that keeps the newest.

    Args:
        kept: how many fates.
    """

    def __init__(self, kept: int = KEPT) -> None:
        self._fates: History[Fate] = History(kept)

    def record(self, fate: Fate) -> None:
        """See MessageLog."""
        self._fates.add(fate)

    def since(self, number: int) -> tuple[int, tuple[Fate, ...], bool]:
        """The number of the first, fates from `number` on as far as they are kept, and whether there are more."""
        first, fates, count = self._fates.since(number, BATCH_BYTES, lambda _: FATE_BYTES)
        return first, tuple(fates), first + len(fates) < count
