"""The controller's dashboard: a connection for each conversation, since what it allows is decided when it is made."""

import socket
from types import TracebackType

DASHBOARD_PORT = 29999
PATIENCE = 2.0
"""s for an answer."""


class DashboardError(OSError):
    """The dashboard does not answer; the text says what happened."""


class Dashboard:
    """A conversation: `with Dashboard(host) as dashboard: dashboard.ask("robotmode")`. Raises DashboardError.

    Args:
        host: address of the controller.
        patience: for each answer (s).
    """

    def __init__(self, host: str, patience: float = PATIENCE) -> None:
        try:
            self._socket = socket.create_connection((host, DASHBOARD_PORT), patience)
        except OSError as error:
            raise DashboardError(f"its dashboard does not answer: {error.strerror or error}") from None
        self._socket.settimeout(patience)
        self._buffer = b""
        try:
            self._line()  # its greeting
        except BaseException:
            self._socket.close()
            raise

    def ask(self, command: str) -> str:
        """What it says to a command."""
        try:
            self._socket.sendall(f"{command}\n".encode())
        except OSError as error:
            raise DashboardError(f"its dashboard does not answer: {error.strerror or error}") from None
        return self._line()

    def __enter__(self) -> "Dashboard":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._socket.close()

    def _line(self) -> str:
        while b"\n" not in self._buffer:
            try:
                data = self._socket.recv(4096)
            except OSError as error:
                raise DashboardError(f"its dashboard does not answer: {error.strerror or error}") from None
            if not data:
                raise DashboardError("its dashboard hung up")
            self._buffer += data
        line, _, self._buffer = self._buffer.partition(b"\n")
        return line.decode("utf-8", "replace").strip()


def is_remote(host: str) -> bool | None:
    """Whether the controller may be controlled from elsewhere; None: it has no such mode. Raises DashboardError."""
    with Dashboard(host) as dashboard:
        said = dashboard.ask("is in remote control").lower()
    return {"true": True, "false": False}.get(said)
