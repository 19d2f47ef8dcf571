"""How many of the robot's states never came, from their numbers and its own stamps.

A state that has not come may be late. And of those that were sent before this side was there, some overtook it and
some did not: none of them is lost, and none of them counts. Which those are, nothing says but their numbers: one counts
if it was sent SETTLE or more after the first one that was heard, on the robot's clock.
"""

from farhand.common.messages.state import RobotState

WINDOW = 4.0
"""Of the newest state's stamp, what is looked at (s)."""
SETTLE = 1.0
"""By how much one message may overtake another (s)."""
COUNTED = WINDOW - SETTLE
"""What is counted: the states of so long, up to those that may still come (s)."""
LEAST = 1.0
"""Of which less is no share: one of two would be half of all (s)."""
JUMP = 100_000
"""Numbers that are farther apart than this are of no one stream."""


class StateLoss:
    """Of the newest session of the robot; a restart of it begins anew."""

    def __init__(self) -> None:
        self._session = 0
        self._first = self._newest = (0, 0)  # number and stamp
        self._there: set[int] = set()  # numbers that came, from _low on
        self._low = self._high = 0  # what is counted: numbers from low up to, not including, high
        self._present = 0  # of these, how many came
        self._share: float | None = None
        self._judged = True  # since the last state

    def received(self, state: RobotState) -> None:
        """Note a state, new, late or there already."""
        self._judged = False
        seq = state.seq
        stamped = seq, state.t_sent_ns
        if state.session != self._session or abs(seq - self._newest[0]) > JUMP:
            self._session = state.session
            self._first = self._newest = stamped
            self._there.clear()
            self._low = self._high = seq
            self._present = 0
        if seq >= self._low and seq not in self._there:
            self._there.add(seq)
            self._present += seq < self._high
        if stamped > self._newest:
            self._newest = stamped

    @property
    def share(self) -> float | None:
        """Fraction that never came; None before there is enough that can be judged."""
        if not self._judged:  # asked more often than a tick, and only a state changes it
            self._judged, self._share = True, self._judge()
        return self._share

    def _judge(self) -> float | None:
        (first, first_ns), (newest, newest_ns) = self._first, self._newest
        if newest_ns <= first_ns:
            return None
        rate_hz = (newest - first) / ((newest_ns - first_ns) * 1e-9)
        settle, window = round(SETTLE * rate_hz), round(WINDOW * rate_hz)
        self._count(max(newest - window + 1, first + settle), newest - settle + 1)
        count = self._high - self._low
        return 1.0 - self._present / count if count and count >= round(LEAST * rate_hz) else None

    def _count(self, low: int, high: int) -> None:
        """Count from `low` up to `high`; neither ever goes back."""
        for seq in range(self._high, high):
            self._present += seq in self._there
        self._high = max(self._high, high)
        for seq in range(self._low, min(low, self._high)):
            if seq in self._there:
                self._there.remove(seq)
                self._present -= 1
        self._low = max(self._low, min(low, self._high))
