"""The link over a Zenoh session, and the session's settings.

TCP only by default: over UDP Zenoh neither retransmits nor keeps late packets. All scouting is off, so that
programs meet only where they are told to. Callbacks only enqueue; a thread of its own publishes, since a put
on a dying link may block.
"""

import json
import threading
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import zenoh

from farhand.common.errors import EndpointError
from farhand.common.link.delivery import CLASSES, class_of
from farhand.common.link.endpoints import check_device, check_name, for_zenoh
from farhand.common.link.keyed_inbox import KeyedInbox
from farhand.common.link.link import Packet
from farhand.common.link.outbox import Outbox
from farhand.common.link.zenoh_threads import resident
from farhand.common.timing.clock import SystemClock
from farhand.common.timing.realtime import request_realtime

LEASE_MS = 1000
CLIENT_PATIENCE_MS = 10_000
BLOCK_BEFORE_CLOSE_US = 200_000
CLOSING_TIME = 1.0
TIMING: tuple[tuple[str, object], ...] = (
    ("transport/link/tx/lease", LEASE_MS),
    ("transport/link/tx/keep_alive", 4),
    ("transport/link/tx/queue/congestion_control/block/wait_before_close", BLOCK_BEFORE_CLOSE_US),
)
"""How soon a session notices that a link is dead; a router must have the same, or all wait for its 10 s."""
_HOW = {
    name: (
        getattr(zenoh.Priority, row.priority),
        zenoh.CongestionControl.BLOCK if row.blocks else zenoh.CongestionControl.DROP,
    )
    for name, row in CLASSES.items()
}


def zenoh_config(
    connect: Sequence[str] = (),
    listen: Sequence[str] = (),
    *,
    mode: str = "peer",
    extra: Iterable[tuple[str, object]] = (),
) -> zenoh.Config:
    """Session settings: no scouting, 1 s lease, endless reconnection, failure when a port is taken.

    Args:
        connect: endpoints to connect to, and to connect to again whenever they are lost.
        listen: endpoints to listen on.
        mode: `peer`; `client` of a router, which does not route between peers; or `router`.
        extra: further (path, value) settings, e.g. for TLS and access control.
    """
    settings: list[tuple[str, object]] = [
        ("mode", mode),
        ("connect/endpoints", [for_zenoh(endpoint) for endpoint in connect]),
        ("listen/endpoints", [for_zenoh(endpoint) for endpoint in listen]),
        ("scouting/multicast/enabled", False),
        ("scouting/gossip/enabled", False),
        *TIMING,
        # A client's session opens only once its router is there, so its patience must end.
        ("connect/timeout_ms", CLIENT_PATIENCE_MS if mode == "client" else -1),
        ("connect/exit_on_failure", mode == "client"),
        ("connect/retry", {"period_init_ms": 100, "period_max_ms": 500, "period_increase_factor": 1.5}),
        ("listen/timeout_ms", 0),
        ("listen/exit_on_failure", True),
        *extra,
    ]
    config = zenoh.Config()
    for path, value in settings:
        config.insert_json5(path, json.dumps(value))
    return config


def open_session(
    connect: Sequence[str] = (),
    listen: Sequence[str] = (),
    *,
    mode: str = "peer",
    extra: Iterable[tuple[str, object]] = (),
) -> zenoh.Session:
    """Open a Zenoh session; raises EndpointError when it cannot listen, or could never connect."""
    for endpoint in (*map(check_name, connect), *listen):
        check_device(endpoint)
    try:
        return zenoh.open(zenoh_config(connect, listen, mode=mode, extra=extra))
    except zenoh.ZError as error:
        where = ", ".join(listen) or ", ".join(connect)
        text = str(error)
        if "in use" in text or "EADDRINUSE" in text or "os error 98" in text:
            raise EndpointError(
                f"endpoint {where}: the port is already in use; choose another or stop who has it"
            ) from None
        if mode == "client":
            raise EndpointError(
                f"endpoint {where}: no Zenoh router answers there for {CLIENT_PATIENCE_MS // 1000} s; "
                "start it, or see address and port (`farhand doctor` says more)"
            ) from None
        raise EndpointError(f"endpoint {where}: cannot be opened: {text.splitlines()[0][:200]}") from None


class ZenohLink:
    """A link over a Zenoh session, to be closed with `close`.

    Args:
        session: an open session; the link closes it.
        subscribe: key expressions to receive.
        clock: stamps arrivals.
        on_arrival: called after each arrival, in a Zenoh thread; must only notify.
        direct: no thread of its own: whoever sends publishes, and may wait for 0.2 s where the link is congested; what
            arrives is taken in Zenoh's thread. For who sends nothing, or is on the host of its other end.

    Attributes:
        mirror: called with each packet that arrives, in a Zenoh thread; must only queue it; None: nobody is.
    """

    def __init__(
        self,
        session: zenoh.Session,
        subscribe: Sequence[str],
        clock: SystemClock,
        on_arrival: Callable[[], None] | None = None,
        *,
        direct: bool = False,
    ) -> None:
        self.session = session
        self.inbox = KeyedInbox()
        self.outbox = Outbox()
        self.put_errors = 0
        self.mirror: Callable[[Packet], None] | None = None
        self._clock = clock
        self._on_arrival = on_arrival
        take: Any = self._receive
        if direct:
            take = zenoh.handlers.Callback(resident(take), indirect=False)
        self._subscribers = [session.declare_subscriber(key, take) for key in subscribe]
        self._direct = direct
        self._thread = threading.Thread(target=self._publish, name="publisher", daemon=True)
        if not direct:
            self._thread.start()

    def send(self, packet: Packet) -> None:
        """Queue a packet for the publishing thread (see Outbox)."""
        if self._direct:
            self._put(packet)
        else:
            self.outbox.put(packet)

    def receive(self) -> list[Packet]:
        """Everything that has arrived since the last call, in order of arrival."""
        return self.inbox.drain()

    def losses(self) -> dict[str, str]:
        """What was lost for want of a place and each of which counts: a line a kind of loss."""
        lost = {f"sent {name}": n for name, n in dict(self.outbox.dropped).items()}
        lost |= {f"arrived {name}": n for name, n in dict(self.inbox.lost).items()}
        return {
            kind: f"{n} {kind.partition(' ')[2]} messages were lost here: {_why(kind)}"
            for kind, n in lost.items()
        }

    def connected(self) -> bool:
        """Whether anybody is connected to the session."""
        info = self.session.info
        return bool(info.peers_zid() or info.routers_zid())

    def close(self, drain_time: float = 0.5) -> None:
        """Send what is queued (at most `drain_time` s), then close the session."""
        self.outbox.close()
        if not self._direct:
            self._thread.join(drain_time)
        # Closing may block on a link that is dying; whoever closes must not.
        closing = threading.Thread(target=self.session.close, name="closing", daemon=True)
        closing.start()
        closing.join(CLOSING_TIME)

    def _receive(self, sample: zenoh.Sample) -> None:
        if sample.kind != zenoh.SampleKind.PUT:
            return
        packet = Packet(str(sample.key_expr), sample.payload.to_bytes(), self._clock.now_ns())
        self.inbox.put(packet)
        if self.mirror is not None:
            self.mirror(packet)
        if self._on_arrival is not None:
            self._on_arrival()

    def _publish(self) -> None:
        request_realtime()
        while (packet := self.outbox.pop()) is not None:
            self._put(packet)

    def _put(self, packet: Packet) -> None:
        priority, congestion = _HOW[class_of(packet.key)]
        try:
            self.session.put(
                packet.key,
                packet.payload,
                express=True,
                priority=priority,
                congestion_control=congestion,
            )
        except zenoh.ZError:
            self.put_errors += 1


def _why(kind: str) -> str:
    sent = kind.startswith("sent")
    return "the link is too slow for what is sent" if sent else "more arrives than this program can take"
