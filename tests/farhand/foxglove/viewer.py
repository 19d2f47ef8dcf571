"""A viewer that speaks Foxglove's websocket protocol (foxglove.sdk.v1) and knows nothing of us."""

import json
import struct
from collections import deque
from contextlib import ExitStack, suppress

from websockets.sync.client import connect

WITHIN = 20.0
MESSAGE, TIME, PLAYBACK_STATE, PLAYBACK_CONTROL = 1, 2, 5, 3
PLAY, PAUSE = 0, 1
PLAYING, PAUSED, ENDED = 0, 1, 3


class Viewer:
    """Args:
    port: of the server on this host.
    """

    def __init__(self, port):
        self._closing = ExitStack()
        self._socket = self._closing.enter_context(
            connect(
                f"ws://127.0.0.1:{port}",
                subprotocols=["foxglove.sdk.v1"],
                max_size=None,
                proxy=None,
                close_timeout=0.2,
            )
        )
        self.channels, self.status, self.times, self.states = {}, {}, [], []
        self.said, self.sessions = deque(), []
        self.info = {}

    def wait(self, until):
        """Take in what comes until something is so."""
        while not until():
            self._take(self._socket.recv(timeout=WITHIN))

    def rest(self, seconds=0.3):
        """Take in all that is on its way."""
        with suppress(TimeoutError):
            while True:
                self._take(self._socket.recv(timeout=seconds))

    def heard(self):
        """Topics of which something came."""
        return {topic for topic, *_ in self.said}

    def subscribe(self):
        """To everything."""
        wanted = [{"id": number, "channelId": number} for number in self.channels]
        self._socket.send(json.dumps({"op": "subscribe", "subscriptions": wanted}))

    def control(self, command, seek_ns=None, speed=1.0, request="r"):
        """Play or pause, and seek."""
        name = request.encode()
        head = struct.pack(
            "<BBfBQI", PLAYBACK_CONTROL, command, speed, seek_ns is not None, seek_ns or 0, len(name)
        )
        self._socket.send(head + name)

    def topics(self):
        """What the server has: topic, encoding, name, encoding and text of the schema."""
        return {
            (
                each["topic"],
                each["encoding"],
                each["schemaName"],
                each.get("schemaEncoding") or "",
                each["schema"],
            )
            for each in self.channels.values()
        }

    def close(self):
        self._closing.close()

    def _take(self, message):
        if isinstance(message, str):
            self._told(json.loads(message))
        elif message[0] == MESSAGE:
            number, at_ns = struct.unpack_from("<IQ", message, 1)
            self.said.append((self.channels[number]["topic"], at_ns, message[13:]))
        elif message[0] == TIME:
            self.times.append(struct.unpack_from("<Q", message, 1)[0])
        elif message[0] == PLAYBACK_STATE:
            status, at_ns, speed, seeked, size = struct.unpack_from("<BQfBI", message, 1)
            self.states.append((status, at_ns, speed, bool(seeked), message[19 : 19 + size].decode()))

    def _told(self, told):
        op = told["op"]
        if op == "serverInfo":
            self.info = told
            self.sessions.append(told["sessionId"])
        elif op == "advertise":
            self.channels |= {each["id"]: each for each in told["channels"]}
        elif op == "status":
            self.status[told.get("id")] = told["message"]
        elif op == "removeStatus":
            for name in told["statusIds"]:
                self.status.pop(name, None)
