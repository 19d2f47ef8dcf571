"""A wire between a browser and the console that can be cut, or held up and let go on."""

import socket
import threading


class Wire:
    """A proxy on loopback.

    Args:
        port: where what comes in goes to.
    """

    def __init__(self, port):
        self._port, self._ends = port, []
        self._goes = threading.Event()
        self._goes.set()
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.port = self._listener.getsockname()[1]
        threading.Thread(target=self._accept, daemon=True).start()

    def cut(self):
        """End every connection; new ones may come."""
        ends, self._ends = self._ends, []
        for end in ends:
            try:
                end.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass

    def hold(self, held=True):
        """Keep all that is said, either way, until it goes on."""
        (self._goes.clear if held else self._goes.set)()

    def close(self):
        self.hold(False)
        self._listener.close()
        self.cut()

    def _accept(self):
        while True:
            try:
                near, _ = self._listener.accept()
                far = socket.create_connection(("127.0.0.1", self._port))
            except OSError:
                return
            self._ends += [near, far]
            for one, other in ((near, far), (far, near)):
                threading.Thread(target=self._pump, args=(one, other), daemon=True).start()

    def _pump(self, one, other):
        try:
            while found := one.recv(65536):
                self._goes.wait()
                other.sendall(found)
        except OSError:
            pass
        for end in (one, other):
            try:
                end.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass
            end.close()
