"""An emulated controller and a connection of it that holds one input, for the protocols of UR arms."""

from functools import lru_cache

from farhand.robot_side.arm.model import ArmModel, model
from farhand.ur_emulator.controller import Controller
from farhand.ur_emulator.wire import Connection


@lru_cache(maxsize=1)
def _arm() -> ArmModel:
    return model("ur5")


def controller() -> Controller:
    """A controller that nothing moves."""
    arm = _arm()
    return Controller(arm, arm.home, 500.0, (5, 12, 0, 1), lambda line: None)


class Input(Connection):
    """A connection on which some bytes have come.

    Args:
        data: the bytes.

    Attributes:
        sent: what was answered.
    """

    def __init__(self, data: bytes) -> None:
        self._data, self.sent, self.closed = data, b"", False

    def send(self, data: bytes, now: float) -> None:
        """Keep it."""
        self.sent += data

    def receive(self, now: float) -> bytes:
        """All at once."""
        data, self._data = self._data, b""
        return data

    def close(self) -> None:
        """Hang up."""
        self.closed = True
