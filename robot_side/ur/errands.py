"""What may wait on the controller, in a thread of its own: the start of a program, the question for remote control."""

import socket
import threading

from farhand.robot_side.ur.dashboard import DashboardError, is_remote

SECONDARY_PORT = 30002
PATIENCE = 2.0
ASK_EVERY = 1.0


class Errands:
    """Done one after the other; the control loop asks for them and reads what came of it, and never waits.

    Args:
        host: address of the controller.

    Attributes:
        remote: whether the controller may be controlled from elsewhere; None: it has no such mode, or nobody knows.
        trouble: what went wrong with the last program that was to be started; empty: nothing.
    """

    def __init__(self, host: str) -> None:
        self._host = host
        self._wake, self._over = threading.Event(), False
        self._program: str | None = None
        self.remote: bool | None = None
        self.trouble = ""
        self._thread = threading.Thread(target=self._work, name="ur-errands", daemon=True)
        self._thread.start()

    def start_program(self, text: str) -> None:
        """Have a program sent; a newer one takes the place of one that still waits."""
        self._program = text
        self._wake.set()

    def close(self) -> None:
        """No more of them."""
        self._over = True
        self._wake.set()
        self._thread.join(PATIENCE + ASK_EVERY)

    def _work(self) -> None:
        while not self._over:
            text, self._program = self._program, None
            if text is not None:
                self._send(text)
            else:
                self._ask()
            if self._program is None and not self._over:
                self._wake.wait(ASK_EVERY)
            self._wake.clear()

    def _send(self, text: str) -> None:
        try:
            send_program(self._host, text)
            self.trouble = ""
        except OSError as error:
            self.trouble = f"the program cannot be sent: {error.strerror or error}"

    def _ask(self) -> None:
        try:
            self.remote = is_remote(self._host)
        except DashboardError:
            self.remote = None


def send_program(host: str, text: str) -> None:
    """Have the controller run a program; raises OSError where its port does not answer."""
    with socket.create_connection((host, SECONDARY_PORT), PATIENCE) as sock:
        sock.settimeout(PATIENCE)
        sock.sendall(text.encode() + (b"" if text.endswith("\n") else b"\n"))
        sock.shutdown(socket.SHUT_WR)
