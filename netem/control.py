"""Live control: a Zenoh queryable on an endpoint that only this host can reach.

Requests are JSON, `{"do": "show"}` or an Action; replies are JSON, `{"ok": true, ...}` or
`{"ok": false, "error": "..."}`. A request that is not exactly right changes nothing.
"""

import threading
from collections import deque
from collections.abc import Callable
from typing import Any

import msgspec
import zenoh

from common.errors import EndpointError, FarhandError, InputError
from common.zenoh_link import check_endpoint, is_loopback, open_session
from netem.action import Action
from netem.netem_node import NetemNode

KEY = "farhand/netem/control"
MAX_REQUEST = 65_536
DEFAULT_ENDPOINT = "tcp/127.0.0.1:7449"


def control_endpoint(text: str) -> str:
    """An endpoint from a port number or an endpoint; raises EndpointError unless it is on loopback."""
    endpoint = check_endpoint(f"tcp/127.0.0.1:{text}" if text.isdigit() else text)
    if not is_loopback(endpoint):
        raise EndpointError(
            f"endpoint {endpoint!r}: live control listens on this host only, e.g. {DEFAULT_ENDPOINT}"
        )
    return endpoint


def handle(node: NetemNode, payload: bytes, now_ns: int) -> bytes:
    """Do what a request says, and the reply to it. Never raises."""
    try:
        if len(payload) > MAX_REQUEST:
            raise InputError(f"request of {len(payload)} bytes; at most {MAX_REQUEST}")
        action = _decode(payload)
        if action is not None:
            action.perform(node, now_ns)
    except FarhandError as error:
        return msgspec.json.encode({"ok": False, "error": str(error)})
    if action is None:
        return msgspec.json.encode({"ok": True, "statistics": node.statistics()})
    specs = {name: str(direction.chain.spec) for name, direction in node.directions.items()}
    own = {
        name: {robot: str(chain.spec) for robot, chain in sorted(direction.own_chains.items())}
        for name, direction in node.directions.items()
    }
    seen = sorted({robot for direction in node.directions.values() for robot in direction.robots})
    return msgspec.json.encode({"ok": True, "specs": specs, "robot_specs": own, "seen": seen})


def _decode(payload: bytes) -> Action | None:
    """The action; None for `show`; raises InputError."""
    try:
        found: Any = msgspec.json.decode(payload)
        if found == {"do": "show"}:
            return None
        return msgspec.convert(found, Action)
    except (msgspec.MsgspecError, ValueError, RecursionError) as error:
        raise InputError(f"request: {error}") from None


class ControlServer:
    """Takes requests from the queryable; they are done in the emulator's thread by `serve`.

    Args:
        endpoint: on loopback.
        wake: called when a request has come, in a Zenoh thread.

    Raises:
        EndpointError: the port is taken.
    """

    def __init__(self, endpoint: str, wake: Callable[[], None]) -> None:
        self._wake = wake
        self._queries: deque[zenoh.Query] = deque(maxlen=64)
        self._session = open_session((), [control_endpoint(endpoint)])
        self._queryable = self._session.declare_queryable(KEY, self._query)

    def serve(self, node: NetemNode, now_ns: int) -> None:
        """Answer all waiting requests."""
        while self._queries:
            query = self._queries.popleft()
            payload = query.payload.to_bytes() if query.payload is not None else b""
            reply = handle(node, payload, now_ns)
            try:
                query.reply(KEY, reply, encoding=zenoh.Encoding.APPLICATION_JSON)
            except zenoh.ZError:
                pass  # whoever asked is gone
            finally:
                query.drop()  # type: ignore[no-untyped-call]

    def close(self) -> None:
        """Stop answering."""
        self._session.close()  # type: ignore[no-untyped-call]

    def _query(self, query: zenoh.Query) -> None:
        self._queries.append(query)
        self._wake()


def ask(endpoint: str, request: dict[str, object], timeout: float = 3.0) -> dict[str, Any]:
    """Send a request to a running emulator; its reply.

    Raises:
        InputError: nobody answers there, or the emulator refused the request.
    """
    endpoint = control_endpoint(endpoint)
    connected = threading.Event()
    session = open_session([endpoint])
    try:
        session.info.declare_transport_events_listener(lambda _: connected.set(), history=True)
        found: dict[str, Any] | None = None
        if connected.wait(timeout):
            for reply in session.get(KEY, payload=msgspec.json.encode(request), timeout=timeout):
                if reply.ok is not None:
                    found = msgspec.json.decode(reply.ok.payload.to_bytes())
    finally:
        session.close()  # type: ignore[no-untyped-call]
    if found is None:
        raise InputError(f"no emulator answers at {endpoint}; start it with --control {endpoint}")
    if not found.get("ok"):
        raise InputError(str(found.get("error", "the request was refused")))
    return found
