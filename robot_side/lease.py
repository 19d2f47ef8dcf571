"""The control lease: one operator session at a time may move the robot."""


class ControlLease:
    """Who holds control, on the robot's own clock.

    Args:
        timeout_ns: a holder that is silent for longer loses control.
    """

    def __init__(self, timeout_ns: int) -> None:
        self._timeout_ns = timeout_ns
        self._heard_ns = 0
        self.holder = 0

    def grant(self, session: int, now_ns: int) -> bool:
        """Give control to `session` unless another one holds it; whether it holds it now."""
        if self.holder not in (0, session):
            return False
        self.holder, self._heard_ns = session, now_ns
        return True

    def renew(self, now_ns: int) -> None:
        """The holder was heard."""
        self._heard_ns = now_ns

    def release(self) -> None:
        """Nobody holds control any more."""
        self.holder = 0

    def expire(self, now_ns: int) -> bool:
        """End the lease of a holder that has been silent for too long; whether that happened now."""
        if self.holder == 0 or now_ns - self._heard_ns <= self._timeout_ns:
            return False
        self.holder = 0
        return True
