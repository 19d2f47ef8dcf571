"""A page as the console hears one, without a browser."""

from contextlib import ExitStack

import msgspec
from websockets.sync.client import connect

from farhand.operator_side.console.server import build_of


class Caller:
    """Args:
    host: HOST:PORT of the console.
    token: what it is let in with.
    secure: TLS settings, where the console has them.
    """

    def __init__(self, host, token="", secure=None, page=None):
        self.secure = secure
        url = f"{'wss' if secure else 'ws'}://{host}/socket"
        headers = {"origin": f"{'https' if secure else 'http'}://{host}"}
        self._closing = ExitStack()
        wanted = connect(
            url, ssl=secure, open_timeout=5, max_size=2**22, compression=None, additional_headers=headers
        )
        self.socket = self._closing.enter_context(wanted)
        self.n, self.began_ns = 0, None
        self.say(kind="hello", page=build_of() if page is None else page, token=token)

    def say(self, **message):
        self.socket.send(msgspec.msgpack.encode(message))

    def says(self, **message):
        """Something that counts in its order."""
        self.n += 1
        self.say(n=self.n, **message)

    def hear(self, kind, holds=lambda told: True, patience=10.0):
        """The next message of a kind of which it holds."""
        for _ in range(int(60 * patience)):
            told = msgspec.msgpack.decode(self.socket.recv(patience))
            if told["kind"] == kind and holds(told):
                return told
        raise AssertionError(f"no {kind} of which it holds")

    def steer(self, now_ns, engaged=False, press=0, linear=(0.0, 1.0, 0.0)):
        self.began_ns = now_ns if self.began_ns is None else self.began_ns
        t = (now_ns - self.began_ns) / 1e6
        self.says(kind="steer", t=t, engaged=engaged, press=press, linear=linear)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        self._closing.close()
