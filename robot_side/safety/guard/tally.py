"""What the guard did in a run, counted and timed."""

from farhand.common.messages.intervention import Intervention

APART_NS = 500_000_000
"""What begins within this after the last is the same intervention, for who counts them."""
MOST_PAIRS = 256


class Tally:
    """Fed once a tick.

    Args:
        dt: control period (s).

    Attributes:
        times: how often it began to do something.
        seconds: for how long it did something (s).
        deeds: the same by what it did (s).
        pairs: by part and obstacle: for how long (s), and the least distance meanwhile (m).
    """

    def __init__(self, dt: float) -> None:
        self._dt = dt
        self._last_ns = -APART_NS
        self._unsent: Intervention | None = None
        self.times = 0
        self.seconds = 0.0
        self.deeds: dict[str, float] = {}
        self.pairs: dict[tuple[str, str], tuple[float, float]] = {}

    def add(self, did: Intervention | None, now_ns: int) -> None:
        """Note what it did in the period that begins now; None: nothing."""
        if did is None:
            return
        self._unsent = did
        if now_ns - self._last_ns >= APART_NS:
            self.times += 1
        self._last_ns = now_ns
        self.seconds += self._dt
        self.deeds[did.what] = self.deeds.get(did.what, 0.0) + self._dt
        pair = did.part, did.obstacle
        if pair in self.pairs or len(self.pairs) < MOST_PAIRS:
            seconds, distance = self.pairs.get(pair, (0.0, did.distance))
            self.pairs[pair] = seconds + self._dt, min(distance, did.distance)

    def forget(self) -> None:
        """The guard acts no more: what was not taken yet is not told as what it does."""
        self._unsent = None

    def take(self) -> Intervention | None:
        """The newest that has not been taken yet."""
        did, self._unsent = self._unsent, None
        return did
