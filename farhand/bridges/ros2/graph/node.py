"""One node of a ROS 2 graph on a Zenoh session: its publishers, subscriptions and services, shown by tokens.

Tokens belong to the session: when the process ends, however it ends, the router takes them away.
"""

from collections import deque
from collections.abc import Callable
from typing import Any, NamedTuple

import zenoh
import zenoh.ext

from farhand.bridges.ros2.cdr.types import Types
from farhand.bridges.ros2.graph.wire import (
    SERVICE,
    Kind,
    Qos,
    attachment_bytes,
    data_key,
    endpoint_token,
    gid_of,
    node_token,
    read_attachment,
)
from farhand.common.link.zenoh_threads import resident
from farhand.common.timing.clock import SystemClock

WAITING = 256
"""Messages of a subscription that may wait; of more the oldest goes."""
HEARTBEAT = 0.5
ASKS_FOR = 1.0
"""So long the graph is asked what it has (s); a router that has nothing says so at once."""
_CDR = zenoh.Encoding.APPLICATION_CDR


class Heard(NamedTuple):
    """Attributes:
    key: under which it came.
    payload: its bytes.
    attachment: as it came; None: there was none.
    arrived_ns: on this process's clock.
    """

    key: str
    payload: bytes
    attachment: bytes | None
    arrived_ns: int


class Publisher:
    """Args:
    session: where to.
    types: of the distribution.
    kind: of its messages.
    key: see data_key.
    qos: of it.
    gid: what identifies it.
    clock: of this process.

    Attributes:
        wanted: whether anybody reads it, or may read later what is latched; what is not wanted is not sent.
        sent, refused: how many messages, and how many of them Zenoh did not take.
    """

    def __init__(self, session: zenoh.Session, types: Types, kind: str, key: str, qos: Qos, gid: bytes,
                 clock: SystemClock) -> None:  # fmt: skip
        self.kind, self.sent, self.refused = kind, 0, 0
        self._types, self._gid, self._clock = types, gid, clock
        # A reader that is slow or dead must never hold this thread, so that congestion drops.
        drop: Any = {"congestion_control": zenoh.CongestionControl.DROP, "encoding": _CDR}
        self._publisher: Any
        self.wanted = qos.latched
        if qos.latched:
            missed: Any = zenoh.ext.MissDetectionConfig  # its stub wants both of its settings
            self._publisher = zenoh.ext.declare_advanced_publisher(
                session,
                key,
                cache=zenoh.ext.CacheConfig(qos.depth),
                publisher_detection=True,
                sample_miss_detection=missed(sporadic_heartbeat=HEARTBEAT),
                **drop,
            )
        else:
            self._publisher = session.declare_publisher(key, express=True, **drop)
            self._listener = self._publisher.declare_matching_listener(self._matched)
            if (
                self._publisher.matching_status.matching
            ):  # never False here: the listener may have known better
                self.wanted = True

    def put(self, message: Any) -> None:
        """Send a message; never waits."""
        if self.wanted:
            self.put_bytes(self._types.encode(message, self.kind))

    def put_bytes(self, payload: bytes) -> None:
        """The same, of CDR bytes."""
        if not self.wanted:
            return
        self.sent += 1
        attachment = attachment_bytes(self.sent, self._clock.time_of_day_ns(), self._gid)
        try:
            self._publisher.put(payload, attachment=attachment)
        except zenoh.ZError:
            self.refused += 1

    def _matched(self, status: zenoh.MatchingStatus) -> None:
        self.wanted = status.matching


class Subscription:
    """What has come on a topic and was not looked at.

    Attributes:
        topic, kind: what it takes.
        lost: messages that found no place.
    """

    def __init__(self, topic: str, kind: str) -> None:
        self.topic, self.kind, self.lost = topic, kind, 0
        self._waiting: deque[Heard] = deque()

    def put(self, heard: Heard) -> None:
        """In a Zenoh thread."""
        if len(self._waiting) >= WAITING:
            self._waiting.popleft()
            self.lost += 1
        self._waiting.append(heard)

    def drain(self) -> list[Heard]:
        """All of it, oldest first."""
        return [self._waiting.popleft() for _ in range(len(self._waiting))]


class ServiceCall:
    """One request, to be answered once.

    Args:
        query: as it came.
        key: of the service.
        types: of the distribution.
        service: its type.
        clock: of this process.

    Attributes:
        request: what is asked.
    """

    def __init__(self, query: zenoh.Query, key: str, types: Types, service: str, clock: SystemClock) -> None:
        payload = query.payload.to_bytes() if query.payload is not None else b""
        self.request: Any = types.decode(payload, f"{service}_Request")
        self._query, self._key, self._types, self._service, self._clock = query, key, types, service, clock
        asked = read_attachment(query.attachment.to_bytes() if query.attachment is not None else None)
        if asked is None:
            raise ValueError("its attachment is none of rmw_zenoh's")
        self._asked = asked

    def answer(self, **fields: Any) -> None:
        """Send the response; from any thread."""
        kind = f"{self._service}_Response"
        payload = self._types.encode(self._types.make(kind, **fields), kind)
        attachment = attachment_bytes(self._asked.seq, self._clock.time_of_day_ns(), self._asked.gid)
        try:
            self._query.reply(self._key, payload, encoding=_CDR, attachment=attachment)
        except zenoh.ZError:
            pass  # whoever asked is gone
        finally:
            self._query.drop()  # type: ignore[no-untyped-call]


def namesakes(session: zenoh.Session, domain: int, namespace: str, name: str) -> int:
    """How many nodes of that name the graph has; asked for once, before one's own."""
    alike = node_token(domain, "*", 0, namespace, name).replace("/0/0/NN/", "/*/*/NN/")
    found = session.liveliness().get(alike, timeout=ASKS_FOR)
    return sum(reply.ok is not None for reply in found)


class RosNode:
    """Args:
    session: a client's, of the router; whoever opened it closes it.
    types: of the distribution.
    clock: of this process.
    domain: ROS_DOMAIN_ID.
    namespace: such as `/farhand`; empty: the root.
    name: of the node.
    wake: called in a Zenoh thread when something has come; must only notify.

    Attributes:
        types: of the distribution.
        token: what shows it.
    """

    def __init__(self, session: zenoh.Session, types: Types, clock: SystemClock, *, domain: int, namespace: str,
                 name: str, wake: Callable[[], None]) -> None:  # fmt: skip
        self._session, self.types, self._clock, self._wake = session, types, clock, wake
        self.domain, self.namespace, self.name = domain, namespace, name
        self.token = node_token(domain, str(session.info.zid()), 0, namespace, name)
        self._numbers = 0
        self._declared: list[Any] = [session.liveliness().declare_token(self.token)]

    def full(self, topic: str) -> str:
        """A name as ROS resolves it: `/name`, `name` in the namespace, `~/name` under the node."""
        if topic.startswith("/"):
            return topic
        own = f"{self.name}/{topic[2:]}" if topic.startswith("~/") else topic
        return f"{self.namespace}/{own}"

    def publisher(self, topic: str, kind: str, qos: Qos) -> Publisher:
        """Publish on a topic."""
        name = self.full(topic)
        token = self._show("MP", name, kind, qos)
        key = data_key(self.domain, name, kind, self.types.hash_of(kind))
        return Publisher(self._session, self.types, kind, key, qos, gid_of(token), self._clock)

    def subscribe(self, topic: str, kind: str, qos: Qos) -> Subscription:
        """Hear a topic: all that comes under its name, of any domain or type, so that it can be refused aloud."""
        name = self.full(topic)
        self._show("MS", name, kind, qos)
        subscription = Subscription(name, kind)

        def take(sample: zenoh.Sample) -> None:
            if sample.kind != zenoh.SampleKind.PUT:
                return
            attached = sample.attachment.to_bytes() if sample.attachment is not None else None
            now_ns = self._clock.now_ns()
            subscription.put(Heard(str(sample.key_expr), sample.payload.to_bytes(), attached, now_ns))
            self._wake()

        take_at_once = zenoh.handlers.Callback(resident(take), indirect=False)  # it only queues
        self._declared.append(self._session.declare_subscriber(f"*{name}/*/*", take_at_once))
        return subscription

    def key_of(self, subscription: Subscription) -> str:
        """Under which the messages come that it takes."""
        return data_key(
            self.domain, subscription.topic, subscription.kind, self.types.hash_of(subscription.kind)
        )

    def serve(self, name: str, service: str, take: Callable[[ServiceCall], None],
              refused: Callable[[str], None]) -> None:  # fmt: skip
        """Answer a service.

        Args:
            name: of the service.
            service: its type.
            take: called in a Zenoh thread with each request; must not wait.
            refused: called with why a request was none.
        """
        full = self.full(name)
        self._show("SS", full, service, SERVICE)
        key = data_key(self.domain, full, service, self.types.hash_of(service))

        def asked(query: zenoh.Query) -> None:
            try:
                call = ServiceCall(query, key, self.types, service, self._clock)
            except Exception as error:
                query.drop()  # type: ignore[no-untyped-call]
                refused(f"{full}: a request was refused: {error}")
                return
            take(call)

        self._declared.append(self._session.declare_queryable(key, asked, complete=True))

    def _show(self, kind: Kind, topic: str, type_name: str, qos: Qos) -> str:
        self._numbers += 1
        token = endpoint_token(
            self.token, self._numbers, kind, topic, type_name, self.types.hash_of(type_name), qos
        )
        self._declared.append(self._session.liveliness().declare_token(token))
        return token
