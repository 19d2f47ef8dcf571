"""Round trip, loss and age, from echoed stamps alone: only this process's clock is ever read.

Network round trip = now - echo.t_sent_ns - echo.hold_ns. As a command is stamped at the beginning of its
tick, the solving time is part of it, as in the paper (arXiv 2403.18650).
"""

import math
from collections import deque
from collections.abc import Collection

from farhand.common.messages.state import RobotState
from farhand.operator_side.sensing.state_loss import StateLoss

SENT = 4096
"""Commands of which none has been answered yet: beyond it the oldest is kept, and the one after it goes."""


class RoundTrip:
    """Statistics of one operator session.

    Args:
        session: this operator's session; echoes of other sessions are ignored.
        window: number of round trips in mean and standard deviation.

    Attributes:
        newest: the newest round trip (s); None before the first.
        mean, std: over the window (s); 0 before the first, and the deviation before the second.
        count, total, total_squares: of all (s, s^2).
    """

    def __init__(self, session: int, window: int) -> None:
        self._session = session
        self._samples: deque[float] = deque(maxlen=window)
        self._sent: deque[tuple[int, int]] = deque()
        self._answered = -1
        self._states = StateLoss()
        self.mean = self.std = 0.0
        self.newest: float | None = None
        self.count = 0
        self.total = 0.0
        self.total_squares = 0.0

    def sent(self, seq: int, t_sent_ns: int) -> None:
        """Note a command that leaves."""
        self._sent.append((seq, t_sent_ns))
        if len(self._sent) > SENT:
            del self._sent[1]

    def received(self, state: RobotState, arrived_ns: int) -> None:
        """Take a sample from the first state that echoes a command; later echoes of it say nothing new."""
        self._states.received(state)
        echo = state.echo
        if echo is None or echo.session != self._session or echo.seq <= self._answered:
            return
        self._answered = echo.seq
        while self._sent and self._sent[0][0] <= echo.seq:
            self._sent.popleft()
        rtt = max(0.0, (arrived_ns - echo.t_sent_ns - echo.hold_ns) * 1e-9)
        self.newest = rtt
        self._samples.append(rtt)
        self.mean, self.std = _moments(self._samples)
        self.count += 1
        self.total += rtt
        self.total_squares += rtt * rtt

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
    def loss(self) -> float | None:
        """Fraction of recent states that never came; None where that is not known yet."""
        return self._states.share


def _moments(samples: Collection[float]) -> tuple[float, float]:
    """Mean and standard deviation."""
    n = len(samples)
    mean = sum(samples) / n
    return mean, math.sqrt(sum([(x - mean) ** 2 for x in samples]) / (n - 1)) if n > 1 else 0.0
