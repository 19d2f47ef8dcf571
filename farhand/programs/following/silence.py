"""An operator's program that does not answer: whether it is only slow, and what is said of it meanwhile."""

from farhand.common.timing.clock import to_ns, to_seconds

SAY_AFTER_NS = to_ns(5.0)
GONE_AFTER_NS = to_ns(30.0)
"""A program that is not connected any more, and silent for so long, is gone; one that is connected is waited for."""


class Silence:
    """Args:
    now_ns: this process's clock.
    """

    def __init__(self, now_ns: int) -> None:
        self._heard_ns, self._said = now_ns, False

    def broken(self, now_ns: int) -> str:
        """It answers; returns what is to be said of that, where its silence had been told."""
        line = f"it answers again, after {self._seconds(now_ns)}" if self._said else ""
        self._heard_ns, self._said = now_ns, False
        return line

    def before_the_first(self, now_ns: int) -> str:
        """Nobody has ever answered; returns what is to be said, once."""
        line = "nobody answers for 5 s; still trying (`farhand operator --report ENDPOINT` does)"
        return line if self._is_to_be_said(now_ns) else ""

    def goes_on(self, now_ns: int) -> str:
        """It answered once and does not now; returns what is to be said, once a silence."""
        line = "the operator's program does not answer for 5 s; what it keeps is fetched when it does again"
        return line if self._is_to_be_said(now_ns) else ""

    def is_for_good(self, now_ns: int, *, connected: bool) -> bool:
        """Whether nothing more is to be expected: its connection closes with its process, and after a long stall."""
        return not connected and now_ns - self._heard_ns > GONE_AFTER_NS

    def words(self, now_ns: int) -> str:
        """Of one that is for good."""
        return (
            f"no connection to the operator's program any more, and no word of it for {self._seconds(now_ns)}"
        )

    def _is_to_be_said(self, now_ns: int) -> bool:
        due = not self._said and now_ns - self._heard_ns > SAY_AFTER_NS
        self._said = self._said or due
        return due

    def _seconds(self, now_ns: int) -> str:
        return f"{to_seconds(now_ns - self._heard_ns):.0f} s"
