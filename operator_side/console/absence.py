"""How long there was no news, told for a while when there is some again."""

SAID_FOR_NS = 5_000_000_000


class Absence:
    """Args:
    unnoticed_ns: after how long without news it counts as lost; it was silent for that long already then.

    Attributes:
    was_lost: for how long there had been no news (s); 0 while there is none, and once it has been said for long enough
        to a robot that may be driven, or somebody has pressed anew.
    """

    def __init__(self, unnoticed_ns: int = 0) -> None:
        self.was_lost = 0.0
        self._unnoticed_ns = unnoticed_ns
        self._since_ns = self._back_ns = self._told_ns = 0
        self._lost = True
        self._ever_there = False

    def note(self, lost: bool, now_ns: int, *, pressed: bool, stopped: bool = False) -> None:
        """Note whether there is news, whether somebody holds something down, whether the robot is stopped."""
        if lost and not self._lost:
            self._since_ns = now_ns - self._unnoticed_ns
        elif not lost and self._lost:
            self.was_lost = (now_ns - self._since_ns) * 1e-9 if self._ever_there else 0.0
            self._back_ns = now_ns
        if stopped and not lost:
            self._told_ns = now_ns  # it stays until the stop is acknowledged, and a moment longer
        if lost or pressed or now_ns - max(self._back_ns, self._told_ns) > SAID_FOR_NS:
            self.was_lost = 0.0
        self._lost = lost
        self._ever_there |= not lost
