"""Connections of the emulated controller: never waiting, delayed or cut off on command."""

import selectors
import socket
from collections import deque
from collections.abc import Callable

from farhand.common.errors import EndpointError

CHUNK = 65_536
MOST_WAITING = 1 << 20
"""Bytes that a client may leave unread; then it is let go, as by a controller whose buffer is full."""


class Wire:
    """The cable that all connections share.

    Attributes:
        cut: nothing comes and nothing goes; what was sent meanwhile comes afterwards, as over TCP.
        latency: each way (s).
    """

    def __init__(self) -> None:
        self.cut, self.latency = False, 0.0


class Connection:
    """One of them.

    Args:
        sock: connected.
        wire: the cable.

    Attributes:
        closed: it is of no further use.
    """

    def __init__(self, sock: socket.socket, wire: Wire) -> None:
        sock.setblocking(False)
        sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._socket, self._wire = sock, wire
        self._in: deque[tuple[float, bytes]] = deque()
        self._out: deque[tuple[float, bytes]] = deque()
        self._waiting = 0
        self._ends = False
        self.closed = False

    def send(self, data: bytes, now: float) -> None:
        """Have bytes sent."""
        if self.closed:
            return
        self._waiting += len(data)
        if self._waiting > MOST_WAITING:
            self.close()
            return
        self._out.append((now + self._wire.latency, data))
        self._flush(now)

    def receive(self, now: float) -> bytes:
        """What has come."""
        if self.closed:
            return b""
        self._flush(now)
        if not self._wire.cut and not self._ends:
            self._read(now)
        found = []
        while self._in and self._in[0][0] <= now:
            found.append(self._in.popleft()[1])
        if self._ends and not self._in:
            self.close()
        return b"".join(found)

    def close(self) -> None:
        """Hang up."""
        self.closed = True
        self._socket.close()

    def _read(self, now: float) -> None:
        try:
            while data := self._socket.recv(CHUNK):
                self._in.append((now + self._wire.latency, data))
            self._ends = True
        except BlockingIOError:
            pass
        except OSError:
            self._ends = True

    def _flush(self, now: float) -> None:
        if self._wire.cut:
            return
        while self._out and self._out[0][0] <= now:
            due, data = self._out.popleft()
            try:
                sent = self._socket.send(data)
            except BlockingIOError:
                sent = 0
            except OSError:
                self.close()
                return
            self._waiting -= sent
            if sent < len(data):
                self._out.appendleft((due, data[sent:]))
                return


class Server:
    """A port, and a handler for each of its connections.

    Args:
        address, port: where; port 0 takes any that is free.
        wire: the cable.
        name: of the port, for messages.
        make: makes the handler of a new connection.

    Attributes:
        port: where it listens.

    Raises EndpointError where the port cannot be had.
    """

    def __init__(
        self, address: str, port: int, wire: Wire, name: str, make: "Callable[[Connection], Handler]"
    ) -> None:
        self._wire, self._make = wire, make
        self._handlers: list[Handler] = []
        self._socket = socket.socket()
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            self._socket.bind((address, port))
        except OSError as error:
            self._socket.close()
            raise EndpointError(
                f"{name} port {port} of {address}: {error.strerror}; choose another"
            ) from None
        self._socket.listen(16)
        self._socket.setblocking(False)
        self._selector = selectors.DefaultSelector()
        self._selector.register(self._socket, selectors.EVENT_READ)
        self.port = int(self._socket.getsockname()[1])

    @property
    def handlers(self) -> "list[Handler]":
        """Of the connections there are."""
        return self._handlers

    def poll(self, now: float) -> None:
        """Take in who connects, hear everybody, forget who is gone."""
        if not self._wire.cut and self._selector.select(0):
            try:
                sock, _ = self._socket.accept()
            except OSError:
                pass
            else:
                self._handlers.append(self._make(Connection(sock, self._wire)))
        for handler in self._handlers:
            handler.poll(now)
        if any(handler.connection.closed for handler in self._handlers):
            for handler in self._handlers:
                if handler.connection.closed:
                    handler.gone()
            self._handlers = [handler for handler in self._handlers if not handler.connection.closed]

    def hang_up(self) -> None:
        """End all connections."""
        for handler in self._handlers:
            handler.connection.close()
            handler.gone()
        self._handlers = []

    def close(self) -> None:
        """End all, and listen no more."""
        self.hang_up()
        self._selector.close()
        self._socket.close()


class Handler:
    """What is at the controller's end of a connection."""

    def __init__(self, connection: Connection) -> None:
        self.connection = connection

    def poll(self, now: float) -> None:
        """Hear what has come, at `now` (s)."""
        raise NotImplementedError

    def gone(self) -> None:
        """The connection has ended."""
