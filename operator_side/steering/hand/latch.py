"""Hold-to-run, enforced where nothing freezes with the hand's own program: who falls silent has let go.

| heard | armed |
|---|---|
| engaged, with a press that is new | yes |
| engaged, with a press that was let go of before, by the hand or by silence | no |
| not engaged | no |
| nothing for SILENCE_NS | no |
"""

SILENCE_NS = 150_000_000
"""Who says nothing for so long has let go."""


class Latch:
    """One hand's. Told of every message in its order, and asked at any time; the instants never go back."""

    def __init__(self) -> None:
        self._press = 0  # the last that counts as seen
        self._heard_ns: int | None = None
        self._armed = False

    def hear(self, engaged: bool, press: int, now_ns: int) -> None:
        """Note a message that arrived at `now_ns`; `press` counts the hand's presses, the first is 1."""
        self._settle(now_ns)
        self._heard_ns = now_ns
        if not engaged:
            self._armed = False
        elif press > self._press:
            self._armed = True
        self._press = max(self._press, press)

    def disarm(self) -> None:
        """Let go: only a new press moves anything again."""
        self._armed = False

    def holds(self, now_ns: int) -> bool:
        """Whether the hand holds the device down at `now_ns`."""
        self._settle(now_ns)
        return self._armed

    def silent(self, now_ns: int) -> bool:
        """Whether nothing has come for SILENCE_NS."""
        return self._heard_ns is None or now_ns - self._heard_ns > SILENCE_NS

    def _settle(self, now_ns: int) -> None:
        if self.silent(now_ns):
            self._armed = False
