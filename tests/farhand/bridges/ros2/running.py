"""The bridge in this process: at a real router, and on its other end a test."""

import itertools
import threading
from contextlib import contextmanager

from farhand.bridges.ros2.bridge import Bridge
from farhand.bridges.ros2.cdr.types import Types
from farhand.bridges.ros2.graph.node import RosNode
from farhand.bridges.ros2.settings import Ros2Options
from farhand.common.link.keyed_inbox import KeyedInbox
from farhand.common.link.link import Packet
from farhand.common.link.zenoh_link import open_session
from farhand.common.messages.codec import Decoder, encode
from farhand.common.messages.keys import mirror_key, report_key
from farhand.common.messages.report import ControlReport
from farhand.common.messages.steering import Steering
from farhand.common.timing.clock import SystemClock
from farhand.common.timing.loop import RealtimeLoop
from tests.farhand.bridges.ros2.peer import PATIENCE


class Desk:
    """Does what services ask for, and remembers it."""

    def __init__(self):
        self.asked = []

    def estop(self):
        self.asked.append("estop")
        return True, "stopped"

    def acknowledge(self):
        self.asked.append("acknowledge")
        return False, "nothing is stopped"

    def kept(self):
        return 0.01


class Running:
    """Attributes:
    told: lines for people.
    steered: what was sent to the operator.
    """

    def __init__(self, port, options):
        self.clock, self.told, self.steered, self.desk = SystemClock(), [], [], Desk()
        self.numbers = itertools.count(1)
        self._inbox, self._changed, self._decoder = KeyedInbox(), threading.Condition(), Decoder(Steering)
        self._session = open_session(
            [f"tcp/127.0.0.1:{port}"], mode="client", extra=[("timestamping/enabled", True)]
        )
        self.zid = str(self._session.info.zid())
        self.loop = None
        sessions = iter((11, 12))
        node = RosNode(self._session, Types(options.distro), self.clock, domain=options.domain,
                       namespace=options.namespace, name="r", wake=self._wake)  # fmt: skip
        self.bridge = Bridge(
            options, node, self, self.desk, self.clock, lambda: next(sessions), self.told.append
        )
        self.loop = RealtimeLoop(self.bridge.node, self.clock, message_driven=True, realtime=False)
        self.loop.after.append(self.bridge.look)
        self._thread = threading.Thread(target=self.loop.run, daemon=True)
        self._thread.start()

    def send(self, packet):
        steering = self._decoder.decode(packet.payload)
        with self._changed:
            self.steered.append(steering)
            self._changed.notify_all()

    def receive(self):
        return self._inbox.drain()

    def feed(self, message, kind=None):
        """Have it come from Farhand: a report, or what is mirrored as that kind."""
        key = report_key("r") if isinstance(message, ControlReport) else mirror_key("r", kind)
        self._inbox.put(Packet(key, encode(message), self.clock.now_ns()))
        self._wake()

    def wait(self, holds, patience=PATIENCE):
        """The first steering of which it holds, of those not looked at; None if none comes."""
        with self._changed:
            at = 0
            while True:
                for steering in self.steered[at:]:
                    if holds(steering):
                        return steering
                at = len(self.steered)
                if not self._changed.wait(patience):
                    return None

    def kill(self):
        """As kill -9 does: nothing is said any more."""
        self._session.close()

    def close(self):
        self.loop.stop()
        self._thread.join()
        self.bridge.close(self.clock.now_ns())
        self._session.close()

    def _wake(self):
        if self.loop is not None:
            self.loop.notify()


@contextmanager
def running(port, **more):
    """A bridge at the router of that port."""
    found = Running(port, Ros2Options(router="", connect="", robot="r", **more))
    try:
        yield found
    finally:
        found.close()
