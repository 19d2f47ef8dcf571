"""`farhand acknowledge`: clears a robot's latched stop, and does no more than that.

It is the operator in control that acknowledges: its running program is asked, on its own host. Where nobody holds
control, the robot is told straight: control is taken with the acknowledgement, and given up at once.
"""

import threading
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from typing import TYPE_CHECKING

import msgspec
import zenoh

from farhand.common.link.requests import Desk, Request, Requests, refusal
from farhand.common.link.zenoh_link import open_session
from farhand.common.messages.base import ZERO
from farhand.common.messages.codec import Decoder, encode
from farhand.common.messages.command import CommandMode, VelocityCommand
from farhand.common.messages.echo import Newest
from farhand.common.messages.keys import acknowledge_key, check_robot_name, command_key, state_key
from farhand.common.messages.state import RobotState
from farhand.common.process.security import Access, local_endpoint, secure, tool_place
from farhand.common.process.signals import say
from farhand.common.timing.clock import SystemClock, to_ns
from farhand.common.timing.slot import NotServedError, Slot
from farhand.operator_side.supervision import holder_name
from farhand.site.estop import REPORT_ENDPOINT, check_rights
from farhand.site.operator_name import operator_name

if TYPE_CHECKING:
    from farhand.operator_side.operator_node import OperatorNode

PATIENCE = 6.0
HELD_PATIENCE = 5.0
"""For the holder's program to be found and to answer, where the robot itself is heard (s)."""
GIVE_UP_NS = 4_000_000_000
SETTLE_NS = 500_000_000
"""A stop that is back within this time was not cleared."""
AGAIN_AFTER = 0.1
ASK_EVERY = 10
_LATCHED = ("stopped", "estop")


def why_not(state: RobotState | None, session: int) -> str:
    """Why an operator cannot acknowledge what the robot shows; empty where it can.

    Args:
        state: the robot's newest.
        session: of the operator.
    """
    if state is None:
        return "nothing has come from the robot yet"
    if state.mode not in _LATCHED:
        return f"there is nothing to acknowledge: robot {state.source!r} is in {state.mode} ({state.reason})"
    if state.holder != session:
        who = f"{holder_name(state)} does" if state.holder else "nobody does"
        return f"this operator does not hold control; {who}"
    return ""


class AcknowledgeServer:
    """The operator's half of `farhand acknowledge`, in a thread of its own; it changes the node through the slot.

    Args:
        node: the operator's node.
        slot: served by the node's loop.
        clock: of this process.
        session: where requests come from, on this host only.
        robot: the robot's name.
        tell: takes a line for people.
    """

    def __init__(
        self,
        node: "OperatorNode",
        slot: Slot,
        clock: SystemClock,
        session: zenoh.Session,
        robot: str,
        tell: Callable[[str], None],
    ) -> None:
        self._node, self._slot, self._say = node, slot, tell
        self._pending: list[Request] = []
        self._reason = ""
        self._begun_ns = 0
        self._cleared_ns: int | None = None
        requests = Requests(session, acknowledge_key(robot))
        self._desk = Desk("acknowledge", lambda request: self.look(request, clock.now_ns()), requests)

    def close(self) -> None:
        """Look no more."""
        self._desk.close()

    def look(self, request: Request | None, now_ns: int) -> None:
        """Begin with a request if one has come, and answer those that are settled."""
        if request is not None and self._pending:
            self._pending.append(request)
        elif request is not None:
            self._begin(request, now_ns)
        if self._pending:
            self._follow(now_ns)

    def _begin(self, request: Request, now_ns: int) -> None:
        node, state = self._node, self._node.state
        why = why_not(state, node.session)
        if node.fault:
            why = f"this operator's program stands for good, and must be started again: {node.fault}"
        elif node.stopping:
            why = "an emergency stop is on its way"
        if why or state is None:
            request.reply(refusal(why))
            return
        try:
            self._slot.do(lambda _: node.acknowledge())
        except NotServedError as error:
            request.reply(refusal(str(error)))
            return
        self._say(f"acknowledges, asked for by `farhand acknowledge`: {state.reason}")
        self._pending.append(request)
        self._reason, self._begun_ns, self._cleared_ns = state.reason, now_ns, None

    def _follow(self, now_ns: int) -> None:
        node, state = self._node, self._node.state
        if node.clearing:
            if now_ns - self._begun_ns > GIVE_UP_NS:
                self._answer(refusal("the robot has not confirmed it; the operator's program goes on asking"))
        elif state is None or state.holder != node.session:
            self._answer(refusal("control was lost meanwhile"))
        elif state.mode in _LATCHED:
            self._answer(refusal(f"the robot stopped again: {state.reason}"))
        elif self._cleared_ns is None:
            self._cleared_ns = now_ns
        elif now_ns - self._cleared_ns >= SETTLE_NS:
            self._answer(msgspec.json.encode({"ok": True, "cleared": self._reason}))

    def _answer(self, answer: bytes) -> None:
        for request in self._pending:
            request.reply(answer)
        self._pending.clear()


def acknowledge(robot: str, connect: Sequence[str], tls: str, router: bool = False) -> int:
    """`farhand acknowledge`: returns 0 once the robot has left its stop, 1 where it has not, which is said.

    Args:
        robot: its name.
        connect: endpoints of an operator's --report, of the robot or of the emulator; empty: those of this host.
        tls: certificate folder; empty: none.
        router: the endpoints are those of a Zenoh router.

    Raises:
        InputError: an endpoint, or the certificate's rights, do not allow it.
    """
    check_robot_name(robot)
    ends = tuple(connect) or (local_endpoint(7447, tls),)
    folder = secure(Access(connect=ends, tls=tls), lambda line: say("acknowledge", line))
    if folder is not None:
        check_rights(folder, robot)
    clock = SystemClock()
    clearing = Clearing(robot, operator_name("", folder), clock.now_ns() | 1)
    with ExitStack() as closing:
        extra = folder.settings(tool_place(folder)) if folder else ()
        sessions = [open_session(ends, mode="client" if router else "peer", extra=extra)]
        if not connect:
            sessions.append(open_session([REPORT_ENDPOINT]))
        for session in sessions:
            closing.callback(session.close)
        _pursue(clearing, sessions, robot, clock)
    if clearing.refusal or not clearing.done:
        tried = ", ".join([*ends, *([REPORT_ENDPOINT] if not connect else [])])
        silent = f"robot {robot!r} and its operator have not answered in {PATIENCE:g} s; tried {tried}"
        say("acknowledge", f"NOT CLEARED: {clearing.refusal or silent}")
        return 1
    print(f"{robot} has left its stop ({clearing.cleared}); it moves when who holds control drives it")
    return 0


class Clearing:
    """What `farhand acknowledge` knows, sends and decides; told by Zenoh's threads, stepped by one loop.

    Args:
        robot: whose stop it is.
        source: who wants it, for the robot.
        session: of the commands that go straight to the robot.

    Attributes:
        cleared: reason of the stop that is to be cleared, or was.
        refusal: why it was not; empty: it was, or it is not decided.
        done: whether it is decided.
    """

    def __init__(self, robot: str, source: str, session: int) -> None:
        self._robot, self._source, self._session = robot, source, session
        self._states = Newest()
        self._state: RobotState | None = None
        self._decoder = Decoder(RobotState)
        self._lock = threading.Lock()
        self._seq = 0
        self._refused_there = ""
        self._stops = 0
        self._acknowledged = False
        self._left_ns: int | None = None  # since when the robot is seen out of its stop
        self.cleared = self.refusal = ""
        self.done = False

    def see(self, payload: bytes, now_ns: int) -> None:
        """Take a state of the robot."""
        state = self._decoder.decode(payload)
        with self._lock:
            if state is not None and self._states.accept(state, now_ns):
                self._state = state

    def hear(self, answer: bytes) -> None:
        """Take the answer of an operator's program."""
        try:
            found = msgspec.json.decode(answer, type=dict[str, str | bool])
        except (msgspec.MsgspecError, ValueError):
            return
        with self._lock:
            if found.get("ok"):
                self.cleared, self.done = str(found.get("cleared", "")), True
            else:
                self._refused_there = str(found.get("error", "the request was refused"))

    def step(self, now_ns: int, waited: float) -> bytes | None:
        """What to send to the robot now; None: nothing.

        Args:
            now_ns: on this process's clock.
            waited: since the start (s).
        """
        with self._lock:
            state = self._state
            if self.done:
                return None
            if state is not None:
                return self._decide(state, now_ns, waited)
            if self._refused_there:
                self._end(self._refused_there)
            return None

    def _decide(self, state: RobotState, now_ns: int, waited: float) -> bytes | None:
        if self._acknowledged:
            return self._finish(state, now_ns)
        if state.holder or self._left_ns is not None:
            self._leave_it_to_the_holder(state, now_ns, waited)
            return None
        why = why_not(state, state.holder)
        if why:
            self._end(why)
            return None
        self.cleared, self._stops = state.reason, state.stops
        self._acknowledged = True
        return self._command("acknowledge", now_ns)

    def _leave_it_to_the_holder(self, state: RobotState, now_ns: int, waited: float) -> None:
        """Its program acknowledges, if it has been found, and answers; no other can."""
        if state.mode in _LATCHED:
            self.cleared, self._left_ns = state.reason, None
        elif self._left_ns is None:
            self._left_ns = now_ns
        if self._refused_there:
            self._end(self._refused_there)
        elif state.mode not in _LATCHED and not self.cleared:
            self._end(why_not(state, state.holder))
        elif self._left_ns is not None:
            self.done = now_ns - self._left_ns > 2 * SETTLE_NS
        elif waited > HELD_PATIENCE:
            self._end(
                f"{holder_name(state)} holds control, and acknowledges ({state.reason}) at its device, or on its "
                "host by `farhand acknowledge` where it runs with --report"
            )

    def _finish(self, state: RobotState, now_ns: int) -> bytes | None:
        """After an acknowledgement of one's own: wait until it holds, then give control up."""
        settled = self._left_ns is not None and now_ns - self._left_ns >= SETTLE_NS
        if state.holder != self._session and settled:
            self.done = True
            return None
        if state.holder not in (0, self._session):
            self._end(f"{holder_name(state)} took control meanwhile")
            return None
        if state.mode in _LATCHED and (state.stops != self._stops or self._left_ns is not None):
            self._end(f"the robot stopped again: {state.reason}")
            return self._command("release", now_ns)
        if state.mode in _LATCHED:
            return self._command("acknowledge", now_ns)
        if self._left_ns is None:
            self._left_ns = now_ns
        # Until then it is heard of, so that the robot does not stop for a silence.
        return self._command("release" if settled else "hold", now_ns)

    def _end(self, why: str) -> None:
        self.refusal, self.done = why, True

    def _command(self, mode: CommandMode, now_ns: int) -> bytes:
        self._seq += 1
        command = VelocityCommand(
            source=self._source,
            session=self._session,
            seq=self._seq,
            t_sent_ns=now_ns,
            echo=self._states.echo(now_ns),
            mode=mode,
            velocity=ZERO,
        )
        return encode(command)


def _pursue(clearing: Clearing, sessions: Sequence[zenoh.Session], robot: str, clock: SystemClock) -> None:
    """Ask and look until it is decided, or nobody answers for long enough."""
    start_ns, pause = clock.now_ns(), threading.Event()
    for session in sessions:
        session.declare_subscriber(
            state_key(robot), lambda sample: clearing.see(sample.payload.to_bytes(), clock.now_ns())
        )
    turn = 0
    while not clearing.done:
        now_ns = clock.now_ns()
        if now_ns - start_ns > to_ns(PATIENCE):
            return
        payload = clearing.step(now_ns, (now_ns - start_ns) * 1e-9)
        for session in sessions:
            if payload is not None:
                session.put(command_key(robot), payload, express=True, priority=zenoh.Priority.REAL_TIME)
            if turn % ASK_EVERY == 2:  # the sessions need a moment to connect
                session.get(acknowledge_key(robot), lambda reply: _hear(clearing, reply), timeout=PATIENCE,
                            payload=b"{}")  # fmt: skip
        turn += 1
        pause.wait(AGAIN_AFTER)


def _hear(clearing: Clearing, reply: zenoh.Reply) -> None:
    if reply.ok is not None:
        clearing.hear(reply.ok.payload.to_bytes())
