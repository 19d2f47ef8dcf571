"""An independent node of a ROS 2 graph (zenoh-ros2-sdk), with definitions handed in; and a router to meet at."""

import logging
import queue
import threading
from contextlib import contextmanager

import zenoh
import zenoh.ext
from zenoh_ros2_sdk import ROS2Publisher, ROS2ServiceClient, ROS2Subscriber
from zenoh_ros2_sdk.session import ZenohSession

from farhand.bridges.ros2.cdr.definitions import SERVICES
from farhand.bridges.ros2.cdr.types import Types
from farhand.bridges.ros2.graph.wire import dds_name
from farhand.common.link.zenoh_link import zenoh_config

PATIENCE = 60.0
PLACEHOLDER = "uint8 structure_needs_at_least_one_member\n"
logging.getLogger("zenoh_ros2_sdk").setLevel(logging.CRITICAL)


@contextmanager
def router(port, *connect):
    """A Zenoh router: `rmw_zenohd` is this very library in this very mode."""
    session = zenoh.open(zenoh_config(connect, [f"tcp/127.0.0.1:{port}"], mode="router"))
    try:
        yield session
    finally:
        session.close()


class Peer:
    """Args:
    port: of its router.
    distro: whose types it has.
    """

    def __init__(self, port, distro="jazzy", domain=0):
        self.types, self._port, self._domain = Types(distro), port, domain
        self._parts = []
        ZenohSession._instance = None
        self.session = ZenohSession.get_instance("127.0.0.1", port)

    def publisher(self, topic, kind, **more):
        return self._keep(ROS2Publisher(topic, kind, **self._common(kind) | more))

    def listen(self, topic, kind, **more):
        """A queue of what comes."""
        found = queue.Queue()
        self._keep(ROS2Subscriber(topic, kind, found.put, **self._common(kind) | more))
        return found

    def late(self, topic, kind):
        """A queue of what is latched, as rmw_zenoh asks for it; the SDK does not find a topic of a namespace."""
        found = queue.Queue()
        key = f"{self._domain}{topic}/{dds_name(kind)}/{self.types.hash_of(kind)}"
        self._keep(
            Undeclared(
                zenoh.ext.declare_advanced_subscriber(
                    self.session.session,
                    key,
                    lambda sample: found.put(self.types.decode(sample.payload.to_bytes(), kind)),
                    history=zenoh.ext.HistoryConfig(detect_late_publishers=True),
                )
            )
        )
        return found

    def call(self, service, kind, **fields):
        common = self._common(kind) | {"timeout": PATIENCE}
        del common["msg_definition"]
        client = self._keep(
            ROS2ServiceClient(
                service,
                kind,
                request_definition=self.types.definition(f"{kind}_Request") or PLACEHOLDER,
                response_definition=self.types.definition(f"{kind}_Response"),
                **common,
            )
        )
        if not SERVICES[kind][0]:
            fields = {"structure_needs_at_least_one_member": 0}
        return client.call(**fields)

    def make(self, kind, **fields):
        return self.session.session and self.session.store.types[kind](**fields)

    def tokens(self):
        return [
            str(reply.ok.key_expr)
            for reply in self.session.session.liveliness().get(f"@ros2_lv/{self._domain}/**", timeout=5)
            if reply.ok is not None
        ]

    def close(self):
        for part in self._parts:
            part.close()
        self.session.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def _keep(self, part):
        self._parts.append(part)
        return part

    def _common(self, kind):
        return {
            "msg_definition": self.types.definition(kind) if "/msg/" in kind else None,
            "type_hash": self.types.hash_of(kind),
            "router_port": self._port,
            "domain_id": self._domain,
        }


class Undeclared:
    """What is undeclared at the end."""

    def __init__(self, part):
        self.close = part.undeclare


class Stream:
    """Publishes the same again and again in a thread, as a teleoperation node does.

    Args:
        publish: sends one message of what is wanted.
        wanted: the first.
        every: s.
    """

    def __init__(self, publish, wanted, every=0.01):
        self.wanted, self.sent = wanted, 0
        self._publish, self._every = publish, every
        self._end = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def close(self):
        self._end.set()
        self._thread.join()

    def _run(self):
        while not self._end.wait(self._every):
            self._publish(self.wanted)
            self.sent += 1


def twist(peer, linear=(0.0, 0.0, 0.0), angular=(0.0, 0.0, 0.0), frame="base", stamp=0):
    """What a TwistStamped is made of."""
    vector = "geometry_msgs/msg/Vector3"
    parts = [
        peer.make(vector, **dict(zip("xyz", map(float, each), strict=True))) for each in (linear, angular)
    ]
    time = peer.make("builtin_interfaces/msg/Time", sec=stamp, nanosec=0)
    return {
        "header": peer.make("std_msgs/msg/Header", stamp=time, frame_id=frame),
        "twist": peer.make("geometry_msgs/msg/Twist", linear=parts[0], angular=parts[1]),
    }
