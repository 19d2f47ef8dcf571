"""Since when the newest state is known: what it shows is no answer to what was asked after that."""

from farhand.common.messages.state import RobotState

ESTOP_AT_LEAST_NS = 1_000_000_000
"""An emergency stop is sent until a state has come so long after that shows one: an earlier state may show another."""


class FirstSeen:
    """Looks at the newest state, tick by tick."""

    def __init__(self) -> None:
        self._key: tuple[int, int] | None = None
        self._at_ns = 0

    def look(self, state: RobotState, now_ns: int) -> int:
        """When this state was looked at first (ns)."""
        key = state.session, state.seq
        if key != self._key:
            self._key, self._at_ns = key, now_ns
        return self._at_ns
