"""Handing control over: the holder's running program is told by `farhand handover` on its own host."""

from collections import deque
from collections.abc import Callable
from typing import TYPE_CHECKING

import msgspec
import zenoh

from farhand.common.errors import FarhandError, InputError
from farhand.common.link.requests import MAX_REQUEST, Desk, Request, Requests, ask, refusal
from farhand.common.messages.keys import check_robot_name, handover_key
from farhand.common.messages.state import RobotState
from farhand.common.timing.clock import SystemClock
from farhand.common.timing.slot import NotServedError, Slot
from farhand.operator_side.supervision import holder_name
from farhand.site.operator_name import check_name

if TYPE_CHECKING:
    from farhand.operator_side.operator_node import OperatorNode

PATIENCE = 10.0
GIVE_UP_NS = 5_000_000_000
TELL_PERIOD_NS = 1_000_000_000
REMEMBERED_ASKERS = 64


class HandoverRequest(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Attributes:
    to: name of who shall get control; empty: the one who waits.
    """

    to: str = ""


def choose(state: RobotState | None, session: int, to: str) -> tuple[int, str]:
    """Session and name of who gets control.

    Args:
        state: the robot's newest.
        session: of the operator that is asked to hand over.
        to: the name, empty for the only one who waits.

    Raises:
        InputError: this operator has no control to hand over, or it is not clear to whom.
    """
    if state is None or state.holder != session:
        who = "nobody does" if state is None or not state.holder else f"{holder_name(state)} does"
        raise InputError(f"this operator does not hold control; {who}")
    if not state.waiting:
        raise InputError("nobody waits for control")
    names = ", ".join(name for _, name in state.waiting)
    found = [one for one in state.waiting if to in ("", one[1])]
    if not found:
        raise InputError(f"--to {to!r}: does not wait for control; waiting: {names}")
    if len(found) > 1:
        which = "--to says which" if not to else "give them different names (`farhand operator --name`)"
        raise InputError(f"{len(found)} wait for control: {names}; {which}")
    return found[0]


class HandoverServer:
    """The operator's half of `farhand handover`, and the lines about who asks, in a thread of its own.

    It looks at what the node knows, and changes it through the slot alone.

    Args:
        node: the operator's node.
        slot: served by the node's loop.
        clock: of this process.
        session: where requests come from, on this host only; None: they cannot.
        robot: the robot's name.
        endpoint: of that session, for the lines.
        tell: takes a line for people.
    """

    def __init__(
        self,
        node: "OperatorNode",
        slot: Slot,
        clock: SystemClock,
        session: zenoh.Session | None,
        robot: str,
        endpoint: str,
        tell: Callable[[str], None],
    ) -> None:
        self._node, self._slot, self._say = node, slot, tell
        self._how = "start this program with --report to hand over by `farhand handover`"
        if session is not None:
            self._how = f"`farhand handover --robot {robot} --connect {endpoint}` hands over"
        self._told: deque[int] = deque(maxlen=REMEMBERED_ASKERS)
        self._pending: tuple[Request, int, str] | None = None
        self._give_up_ns = self._tell_ns = 0
        requests = None if session is None else Requests(session, handover_key(robot))
        self._desk = Desk("handover", lambda request: self.look(request, clock.now_ns()), requests)

    def close(self) -> None:
        """Look no more."""
        self._desk.close()

    def look(self, request: Request | None, now_ns: int) -> None:
        """Look at what has changed, and at a request if one has come."""
        if now_ns >= self._tell_ns:
            self._tell(now_ns)
        if self._pending is not None and (self._node.successor == 0 or now_ns > self._give_up_ns):
            self._conclude(*self._pending)
        if request is not None:
            self._begin(request, now_ns)

    def _tell(self, now_ns: int) -> None:
        """Say who asks, each once, and at most one a second whatever a stranger sends."""
        state = self._node.state
        if state is None or state.holder != self._node.session:
            return
        new = [one for one in state.waiting if one[0] not in self._told]
        if new:
            session, name = new[0]
            self._told.append(session)
            self._tell_ns = now_ns + TELL_PERIOD_NS
            self._say(f"{name} asks for control; {self._how}")

    def _begin(self, request: Request, now_ns: int) -> None:
        try:
            if len(request.payload) > MAX_REQUEST:
                raise InputError(f"request of {len(request.payload)} bytes; at most {MAX_REQUEST}")
            if self._pending is not None:
                raise InputError(f"control is being handed over to {self._pending[2]}")
            to = msgspec.json.decode(request.payload, type=HandoverRequest).to
            session, name = choose(self._node.state, self._node.session, to)
            self._slot.do(lambda _: self._node.hand_over(session))
        except (FarhandError, msgspec.MsgspecError, ValueError, RecursionError) as error:
            request.reply(refusal(str(error)))
            return
        self._pending, self._give_up_ns = (request, session, name), now_ns + GIVE_UP_NS

    def _conclude(self, request: Request, session: int, name: str) -> None:
        self._pending = None
        try:
            self._slot.do(lambda _: self._node.hand_over(0))
        except NotServedError as error:
            request.reply(refusal(str(error)))
            return
        state = self._node.state
        if state is not None and state.holder == session:
            self._say(f"handed control over to {name}")
            request.reply(msgspec.json.encode({"ok": True, "to": name}))
        elif state is not None and state.holder == self._node.session:
            why = "waits no more" if session not in dict(state.waiting) else "was not confirmed by the robot"
            request.reply(refusal(f"{name} {why}; this operator goes on"))
        else:
            request.reply(refusal(f"control was lost before {name} had it"))


def hand_over(endpoint: str, robot: str, to: str) -> int:
    """`farhand handover`: returns 0 once the other one holds control; raises InputError if it cannot be."""
    check_robot_name(robot)
    if to:
        check_name(to, "--to")
    nobody = (
        f"no operator of robot {robot!r} answers at {endpoint}; it must run on this host "
        f"with --report {endpoint}"
    )
    found = ask(endpoint, handover_key(robot), HandoverRequest(to), nobody, PATIENCE)
    print(f"{found['to']} holds control of {robot}")
    return 0
