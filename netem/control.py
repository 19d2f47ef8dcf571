"""Live control: a Zenoh queryable on an endpoint that only this host can reach.

Requests are JSON, `{"do": "show"}` or an Action; replies are JSON, `{"ok": true, ...}` or
`{"ok": false, "error": "..."}`. A request that is not exactly right changes nothing.
"""

from collections.abc import Callable
from typing import Any

import msgspec

from farhand.common.errors import EndpointError, FarhandError, InputError
from farhand.common.link.endpoints import check_endpoint, is_loopback
from farhand.common.link.requests import MAX_REQUEST, Desk, Request, Requests, refusal
from farhand.common.link.requests import ask as ask_program
from farhand.common.link.zenoh_link import open_session
from farhand.common.timing.slot import Slot
from farhand.netem.action import Action
from farhand.netem.endpoints import DEFAULT_ENDPOINT
from farhand.netem.measure.result import NetemResult
from farhand.netem.models.sampler import load
from farhand.netem.netem_node import NetemNode

KEY = "farhand/netem/control"
LOOKS = 20


def control_endpoint(text: str) -> str:
    """An endpoint from a port number or an endpoint; raises EndpointError unless it is on loopback."""
    endpoint = check_endpoint(f"tcp/127.0.0.1:{text}" if text.isdigit() else text)
    if not is_loopback(endpoint):
        raise EndpointError(
            f"endpoint {endpoint!r}: live control listens on this host only, e.g. {DEFAULT_ENDPOINT}"
        )
    return endpoint


def handle(node: NetemNode, payload: bytes, now_ns: int) -> bytes:
    """Do what a request says at `now_ns`, and the reply to it. Never raises. For virtual time."""
    return answer(node, payload, lambda change: change(now_ns))


def answer(node: NetemNode, payload: bytes, apply: Callable[[Callable[[int], Any]], Any]) -> bytes:
    """The reply to a request. Never raises.

    Args:
        node: the emulator, which may be running in another thread.
        payload: the request, as it came.
        apply: has a decided change done in the node's thread, at the time that it is given there.
    """
    try:
        if len(payload) > MAX_REQUEST:
            raise InputError(f"request of {len(payload)} bytes; at most {MAX_REQUEST}")
        action = _decode(payload)
        if action is None:
            conserved, left = apply(lambda now_ns: (_conserved(node), _outage_left(node, now_ns)))
            statistics = msgspec.structs.replace(look_at(node), conserved=conserved)
            return msgspec.json.encode({"ok": True, "statistics": statistics, "outage_left": left})
        action.check()  # reads the files that it names, which are then known to `perform`
        apply(lambda now_ns: action.perform(node, now_ns))
    except FarhandError as error:
        return refusal(str(error))
    specs = {name: str(direction.chain.spec) for name, direction in node.directions.items()}
    own = {
        name: {robot: str(chain.spec) for robot, chain in sorted(direction.own_chains.items())}
        for name, direction in node.directions.items()
    }
    seen = sorted({robot for direction in node.directions.values() for robot in list(direction.robots)})
    return msgspec.json.encode({"ok": True, "specs": specs, "robot_specs": own, "seen": seen})


def look_at(node: NetemNode) -> NetemResult:
    """The statistics of a node that may be running in another thread, which does not wait for it.

    Counters may differ by the messages that passed meanwhile.
    """
    for _ in range(LOOKS):
        try:
            return node.statistics()
        except RuntimeError:  # a robot or a bin was new at that very moment
            continue
    return node.statistics()


def _conserved(node: NetemNode) -> bool:
    """The same as the node's own word, but quick: it is asked in the node's thread."""
    for direction in node.directions.values():
        each = direction.robots.values()
        if sum(s.queued for s in each) != len(direction.queue) or not all(s.conserved() for s in each):
            return False
    return True


def _outage_left(node: NetemNode, now_ns: int) -> float:
    """For how long there is no network for anybody, in one direction at least (s)."""
    return max(each.outage_ends_ns(now_ns) - now_ns for each in node.directions.values()) * 1e-9


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
    """Reads, checks and answers requests in a thread of its own; what they change is done by the slot.

    Args:
        endpoint: on loopback.
        node: the emulator.
        slot: served by the node's loop.

    Attributes:
        session: on that endpoint.

    Raises:
        EndpointError: the port is taken.
    """

    def __init__(self, endpoint: str, node: NetemNode, slot: Slot) -> None:
        self._node, self._slot = node, slot
        load()
        self.session = open_session((), [control_endpoint(endpoint)])
        self._desk = Desk("control", self._look, Requests(self.session, KEY))

    def close(self) -> None:
        """Stop answering."""
        self._desk.close()
        self.session.close()  # type: ignore[no-untyped-call]

    def _look(self, request: Request | None) -> None:
        if request is not None:
            request.reply(answer(self._node, request.payload, self._slot.do))


def ask(endpoint: str, request: dict[str, object], timeout: float = 3.0) -> dict[str, Any]:
    """Send a request to a running emulator; its reply.

    Raises:
        InputError: nobody answers there, or the emulator refused the request.
    """
    endpoint = control_endpoint(endpoint)
    nobody = f"no emulator answers at {endpoint}; start it with --control {endpoint}"
    return ask_program(endpoint, KEY, request, nobody, timeout, timeout)
