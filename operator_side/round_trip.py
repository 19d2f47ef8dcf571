"""Round trip, loss and age, from echoed stamps alone: only this process's clock is ever read.

Network round trip = now - echo.t_sent_ns - echo.hold_ns. As a command is stamped at the beginning of its
tick, the solving time is part of it, as in the paper (arXiv 2403.18650).
"""

import math
from collections import deque
from collections.abc import Sequence

from farhand.common.messages.state import RobotState

LOSS_WINDOW = 200
LOSS_SETTLE = 50


class RoundTrip:
    """Statistics of one operator session.

    Args:
        session: this operator's session; echoes of other sessions are ignored.
        window: number of round trips in mean and standard deviation.
    """

    def __init__(self, session: int, window: int) -> None:
        self._session = session
        self._samples: deque[float] = deque(maxlen=window)
        self._sent: deque[tuple[int, int]] = deque(maxlen=4096)
        self._answered = -1
        self._state_seqs: deque[int] = deque(maxlen=LOSS_WINDOW)
        self._mean, self._std = 0.0, 0.0  # over the window
        self.newest: float | None = None
        self.count = 0
        self.total = 0.0
        self.total_squares = 0.0

    def sent(self, seq: int, t_sent_ns: int) -> None:
        """Note a command that leaves."""
        self._sent.append((seq, t_sent_ns))

    def received(self, state: RobotState, arrived_ns: int) -> None:
        """Take a sample from the first state that echoes a command; later echoes of it say nothing new."""
        self._state_seqs.append(state.seq)
        echo = state.echo
        if echo is None or echo.session != self._session or echo.seq <= self._answered:
            return
        self._answered = echo.seq
        while self._sent and self._sent[0][0] <= echo.seq:
            self._sent.popleft()
        rtt = max(0.0, (arrived_ns - echo.t_sent_ns - echo.hold_ns) * 1e-9)
        self.newest = rtt
        self._samples.append(rtt)
        self._mean, self._std = _mean_and_std(self._samples)
        self.count += 1
        self.total += rtt
        self.total_squares += rtt * rtt

    @property
    def mean(self) -> float:
        """Mean round trip over the window (s); 0 before the first sample."""
        return self._mean

    @property
    def std(self) -> float:
        """Standard deviation over the window (s)."""
        return self._std

    def overall(self) -> tuple[float | None, float | None]:
        """Mean and standard deviation over the whole session (s); None without samples."""
        if self.count == 0:
            return None, None
        mean = self.total / self.count
        if self.count < 2:
            return mean, 0.0
        variance = (self.total_squares - self.count * mean * mean) / (self.count - 1)
        return mean, math.sqrt(max(0.0, variance))

    def age(self, now_ns: int) -> float:
        """Age of the oldest command that no state has answered yet (s); 0 if all are answered.

        Statistics of echoes are blind during an outage; this is not.
        """
        return (now_ns - self._sent[0][1]) * 1e-9 if self._sent else 0.0

    @property
    def loss(self) -> float:
        """Fraction of recent states that never came; the newest 50 are left out, as they may yet come."""
        if not self._state_seqs:
            return 0.0
        newest = max(self._state_seqs)
        low = max(newest - LOSS_WINDOW + 1, min(self._state_seqs))
        high = newest - LOSS_SETTLE
        if high <= low:
            return 0.0
        present = len(set(self._state_seqs).intersection(range(low, high + 1)))
        return max(0.0, 1.0 - present / (high - low + 1))


def _mean_and_std(samples: Sequence[float]) -> tuple[float, float]:
    n = len(samples)
    mean = sum(samples) / n
    return mean, math.sqrt(sum([(x - mean) ** 2 for x in samples]) / (n - 1)) if n > 1 else 0.0
