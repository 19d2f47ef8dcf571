"""Sockets that a program opens, towards clients that listen."""

import errno
import select
import socket
import struct

from farhand.ur_emulator.wire import Connection, Wire

MOST_SOCKETS = 8


class ProgramSockets:
    """All of one controller's; a program's end closes them.

    Args:
        wire: the cable.
    """

    def __init__(self, wire: Wire) -> None:
        self._wire = wire
        self._opening: dict[str, socket.socket] = {}
        self._open: dict[str, Connection] = {}
        self._unread: dict[str, bytearray] = {}
        self.now = 0.0

    def open(self, address: str, port: int, name: str) -> bool:
        """Begin to connect; whether that could be begun."""
        self.close(name)
        if len(self._open) + len(self._opening) >= MOST_SOCKETS:
            return False
        sock = socket.socket()
        sock.setblocking(False)
        try:
            failed = sock.connect_ex((address, port)) not in (0, errno.EINPROGRESS)
        except (OSError, OverflowError):
            failed = True
        if failed:
            sock.close()
            return False
        self._opening[name] = sock
        return True

    def state(self, name: str) -> bool | None:
        """Whether it is connected; None: not yet known."""
        if name in self._open:
            return not self._open[name].closed
        sock = self._opening.get(name)
        if sock is None:
            return False
        if self._wire.cut or not select.select([], [sock], [], 0)[1]:
            return None
        del self._opening[name]
        if sock.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR):
            sock.close()
            return False
        self._open[name], self._unread[name] = Connection(sock, self._wire), bytearray()
        return True

    def read_integers(self, name: str, number: int) -> list[int] | None:
        """The number of integers and they, big-endian; None where not all have come; -1 where nobody is there."""
        connection, unread = self._open.get(name), self._unread.get(name)
        if connection is None or unread is None:
            return [-1] + [-1] * number
        if len(unread) < 4 * number:
            unread += connection.receive(self.now)
        if len(unread) >= 4 * number:
            values = struct.unpack_from(f">{number}i", unread)
            del unread[: 4 * number]
            return [number, *values]
        return [-1] + [-1] * number if connection.closed else None

    def send_int(self, value: int, name: str = "socket_0") -> bool:
        """Send one integer; whether there is somebody."""
        connection = self._open.get(name)
        if connection is None or connection.closed:
            return False
        connection.send(struct.pack(">i", int(value)), self.now)
        return not connection.closed

    def close(self, name: str = "socket_0") -> None:
        """Hang up one."""
        opening = self._opening.pop(name, None)
        if opening is not None:
            opening.close()
        connection = self._open.pop(name, None)
        if connection is not None:
            connection.close()
        self._unread.pop(name, None)

    def close_all(self) -> None:
        """Hang up all."""
        for name in [*self._open, *self._opening]:
            self.close(name)
