"""Live control: a Zenoh queryable on an endpoint that only this host can reach.

Requests are JSON, `{"do": "show"}` or an Action; replies are JSON, `{"ok": true, ...}` or
`{"ok": false, "error": "..."}`. A request that is not exactly right changes nothing.
"""

from collections.abc import Callable
from typing import Any

import msgspec

from farhand.common.errors import EndpointError, FarhandError, InputError
from farhand.common.link.requests import MAX_REQUEST, Requests
from farhand.common.link.requests import ask as ask_program
from farhand.common.link.zenoh_link import check_endpoint, is_loopback, open_session
from farhand.netem.action import Action
from farhand.netem.endpoints import DEFAULT_ENDPOINT
from farhand.netem.netem_node import NetemNode

KEY = "farhand/netem/control"


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
        self._session = open_session((), [control_endpoint(endpoint)])
        self._requests = Requests(self._session, KEY, wake)

    def serve(self, node: NetemNode, now_ns: int) -> None:
        """Answer all waiting requests."""
        while (request := self._requests.pop()) is not None:
            request.reply(handle(node, request.payload, now_ns))

    def close(self) -> None:
        """Stop answering."""
        self._session.close()  # type: ignore[no-untyped-call]


def ask(endpoint: str, request: dict[str, object], timeout: float = 3.0) -> dict[str, Any]:
    """Send a request to a running emulator; its reply.

    Raises:
        InputError: nobody answers there, or the emulator refused the request.
    """
    endpoint = control_endpoint(endpoint)
    nobody = f"no emulator answers at {endpoint}; start it with --control {endpoint}"
    return ask_program(endpoint, KEY, request, nobody, timeout, timeout)
