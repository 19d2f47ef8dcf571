"""One side of the proxy: a Zenoh session seen as a link that carries everything, metadata and all.

What arrives is turned into packets whose envelope says what it was (publication, delete, query, reply or
liveliness token); `send` turns a packet back into that on the other side's session. Callbacks only enqueue.
"""

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import zenoh

from farhand.common.link.keyed_inbox import KeyedInbox
from farhand.common.link.link import Packet
from farhand.common.messages.keys import PREFIX, kind_of
from farhand.common.timing.clock import SystemClock
from farhand.netem.envelope import MustArrive

EVERYTHING = "**"
ROS_GRAPH, ROS_SERVICE = "@ros2_lv/**", "::srv::dds_::"
ROS_SERVICES = f"**/$*{ROS_SERVICE}$*/*"
"""Requests of ROS go to complete queryables alone; a service that is not beyond the emulator answers as little."""
ADVANCED = "**/@adv/**"
"""Parts that begin with @ are never matched by `**`: the graph of ROS 2, and Zenoh's caches for who comes late."""
INBOX_LIMIT = 100_000
QUERY_TIMEOUT = 30.0
_LOCAL_KINDS = frozenset({"report"})
_REMOTE = zenoh.Locality.REMOTE


@dataclass(frozen=True, slots=True)
class Publication:
    """Envelope of a PUT or DELETE: all that Zenoh lets a forwarder copy."""

    deleted: bool
    encoding: zenoh.Encoding
    congestion_control: zenoh.CongestionControl
    priority: zenoh.Priority
    express: bool
    attachment: zenoh.ZBytes | None
    timestamp: zenoh.Timestamp | None
    source_info: zenoh.SourceInfo | None

    @classmethod
    def of(cls, sample: zenoh.Sample) -> "Publication":
        """The metadata of a sample."""
        return cls(
            sample.kind == zenoh.SampleKind.DELETE,
            sample.encoding,
            sample.congestion_control,
            sample.priority,
            sample.express,
            sample.attachment,
            sample.timestamp,
            sample.source_info,
        )


@dataclass(frozen=True, slots=True)
class RelayedQuery:
    """Envelope of a query. Zenoh ends the query when the last reference to it is gone, so every envelope
    that may still bring a reply holds one, and a lost request or reply needs no book-keeping."""

    query: zenoh.Query
    selector: str
    has_payload: bool
    encoding: zenoh.Encoding | None
    attachment: zenoh.ZBytes | None


@dataclass(frozen=True, slots=True)
class Answer:
    """Envelope of one reply to a query; `publication` is None for an error reply."""

    query: zenoh.Query
    publication: Publication | None
    encoding: zenoh.Encoding | None


@dataclass(frozen=True, slots=True)
class Token(MustArrive):
    """Envelope of a liveliness token that came or went; must not be lost, or it would never be put right."""

    alive: bool
    number: int


class ZenohSide:
    """A link over one of the proxy's two sessions.

    Args:
        name: "operator" or "robot".
        session: open; closed by `close`.
        clock: stamps arrivals.
        wake: called after each arrival in a Zenoh thread; must only notify.

    Attributes:
        peers: Zenoh ids of those connected now.
        errors: sendings that Zenoh refused, by kind.
        local: messages that stay on their side by definition (reports, emulator control).
    """

    def __init__(
        self, name: str, session: zenoh.Session, clock: SystemClock, wake: Callable[[], None]
    ) -> None:
        self.name = name
        self.session = session
        self.inbox = KeyedInbox(INBOX_LIMIT, INBOX_LIMIT, INBOX_LIMIT)  # a network forgets nothing
        self.peers: set[str] = set()
        self.errors: Counter[str] = Counter()
        self.local = 0
        self._clock = clock
        self._wake = wake
        self._tokens: dict[str, Any] = {}
        self._token_numbers: dict[str, int] = {}
        self._token_count = 0

    def open(self, on_peers: Callable[[], None]) -> None:
        """Start to receive; `on_peers` is called in a Zenoh thread when a peer comes or goes."""

        def transport(event: zenoh.TransportEvent) -> None:
            change = self.peers.add if event.kind == zenoh.SampleKind.PUT else self.peers.discard
            change(str(event.transport.zid))
            on_peers()

        session = self.session
        self._declared: list[Any] = [
            session.info.declare_transport_events_listener(transport, history=True),
            session.declare_subscriber(EVERYTHING, self._sample, allowed_origin=_REMOTE),
            session.declare_subscriber(ADVANCED, self._sample, allowed_origin=_REMOTE),
            session.declare_queryable(EVERYTHING, self._query, allowed_origin=_REMOTE),
            session.declare_queryable(ADVANCED, self._query, allowed_origin=_REMOTE),
            session.declare_queryable(ROS_SERVICES, self._request, complete=True, allowed_origin=_REMOTE),
            *(
                session.liveliness().declare_subscriber(tokens, self._liveliness, history=True)
                for tokens in (EVERYTHING, ROS_GRAPH, ADVANCED)
            ),
        ]

    def announce(self, key: str, answer: Callable[[], bytes], about: str) -> None:
        """Show under a liveliness token of our own that the emulator is there, and answer what it is."""

        def reply(query: zenoh.Query) -> None:
            query.reply(about, answer())

        self._tokens[key] = None  # ours: never carried to the other side
        self._tokens[key] = self.session.liveliness().declare_token(key)
        self._declared.append(self.session.declare_queryable(about, reply))

    def receive(self) -> list[Packet]:
        """Everything that has arrived since the last call, in order of arrival."""
        return self.inbox.drain()

    def send(self, packet: Packet) -> None:
        """Publish, delete, ask, answer or declare; what Zenoh refuses is counted in `errors`."""
        envelope = packet.envelope
        try:
            if isinstance(envelope, Publication):
                self._publish(packet, envelope)
            elif isinstance(envelope, Token):
                self._declare(packet.key, envelope)
            elif isinstance(envelope, RelayedQuery):
                self._ask(packet, envelope)
            elif isinstance(envelope, Answer):
                _answer(packet, envelope)
        except zenoh.ZError:
            self.errors[type(envelope).__name__.lower()] += 1

    def close(self) -> None:
        """Close the session."""
        self.session.close()  # type: ignore[no-untyped-call]

    def _put(self, key: str, payload: bytes, envelope: object) -> None:
        self.inbox.put(Packet(key, payload, self._clock.now_ns(), envelope))
        self._wake()

    def _sample(self, sample: zenoh.Sample) -> None:
        key = str(sample.key_expr)
        if kind_of(key) in _LOCAL_KINDS or key.startswith(f"{PREFIX}/netem/"):
            self.local += 1
            return
        self._put(key, sample.payload.to_bytes(), Publication.of(sample))

    def _query(self, query: zenoh.Query) -> None:
        if ROS_SERVICE not in str(query.key_expr):  # those come by the complete one as well
            self._request(query)

    def _request(self, query: zenoh.Query) -> None:
        payload = query.payload
        request = RelayedQuery(
            query, str(query.selector), payload is not None, query.encoding, query.attachment
        )
        self._put(str(query.key_expr), payload.to_bytes() if payload is not None else b"", request)

    def _liveliness(self, sample: zenoh.Sample) -> None:
        key = str(sample.key_expr)
        if key in self._tokens:
            return  # our own mirror of a token of the other side
        self._token_count += 1
        self._put(key, b"", Token(sample.kind == zenoh.SampleKind.PUT, self._token_count))

    def _publish(self, packet: Packet, envelope: Publication) -> None:
        if envelope.deleted:
            self.session.delete(
                packet.key,
                congestion_control=envelope.congestion_control,
                priority=envelope.priority,
                express=envelope.express,
                attachment=envelope.attachment,
                timestamp=envelope.timestamp,
                source_info=envelope.source_info,
                allowed_destination=_REMOTE,
            )
            return
        self.session.put(
            packet.key,
            packet.payload,
            encoding=envelope.encoding,
            congestion_control=envelope.congestion_control,
            priority=envelope.priority,
            express=envelope.express,
            attachment=envelope.attachment,
            timestamp=envelope.timestamp,
            source_info=envelope.source_info,
            allowed_destination=_REMOTE,
        )

    def _declare(self, key: str, token: Token) -> None:
        if token.number < self._token_numbers.get(key, 0):
            return  # overtaken by a newer change
        self._token_numbers[key] = token.number
        if token.alive and key not in self._tokens:
            # The key is noted before the declaration, whose echo may come at once.
            self._tokens[key] = None
            self._tokens[key] = self.session.liveliness().declare_token(key)
        elif not token.alive and self._tokens.get(key) is not None:
            self._tokens[key].undeclare()
            del self._tokens[key]

    def _ask(self, packet: Packet, envelope: RelayedQuery) -> None:
        query = envelope.query

        def reply(reply: zenoh.Reply) -> None:
            if reply.ok is not None:
                sample = reply.ok
                answer = Answer(query, Publication.of(sample), None)
                self._put(str(sample.key_expr), sample.payload.to_bytes(), answer)
            elif reply.err is not None:
                error = reply.err
                self._put(packet.key, error.payload.to_bytes(), Answer(query, None, error.encoding))

        self.session.get(
            envelope.selector,
            reply,
            target=zenoh.QueryTarget.ALL,
            consolidation=zenoh.ConsolidationMode.NONE,
            accept_replies=query.accepts_replies(),
            timeout=QUERY_TIMEOUT,
            payload=packet.payload if envelope.has_payload else None,
            encoding=envelope.encoding,
            attachment=envelope.attachment,
            allowed_destination=_REMOTE,
        )


def _answer(packet: Packet, envelope: Answer) -> None:
    publication = envelope.publication
    if publication is None:
        envelope.query.reply_err(packet.payload, encoding=envelope.encoding)
    elif publication.deleted:
        envelope.query.reply_del(
            packet.key, attachment=publication.attachment, timestamp=publication.timestamp
        )
    else:
        envelope.query.reply(
            packet.key,
            packet.payload,
            encoding=publication.encoding,
            express=publication.express,
            attachment=publication.attachment,
            timestamp=publication.timestamp,
        )
