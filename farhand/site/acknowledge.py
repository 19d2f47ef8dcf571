"""`farhand acknowledge`: clears a robot's latched stop, and does no more than that.

It is the operator in control that acknowledges: its running program is asked, on its own host. Where nobody holds
control, the robot is told straight: control is taken with the acknowledgement, and given up at once.
"""

import threading
from collections.abc import Sequence

import msgspec
import zenoh

from farhand.common.link.requests import Request, refusal
from farhand.common.messages.keys import acknowledge_key, command_key, state_key
from farhand.common.process.signals import say
from farhand.common.timing.clock import SystemClock, to_ns
from farhand.site.clearing import LATCHED, SETTLE_NS, Clearing, still_stopped, why_not
from farhand.site.desk import GIVE_UP_NS, OperatorDesk
from farhand.site.reach import reaching

PATIENCE = 6.0
AGAIN_AFTER = 0.1
ASK_EVERY = 10


class AcknowledgeServer(OperatorDesk):
    """The operator's half of `farhand acknowledge`."""

    name = "acknowledge"
    _reason, _stops = "", 0
    _begun_ns = 0
    _cleared_ns: int | None = None

    @staticmethod
    def key(robot: str) -> str:
        """See OperatorDesk."""
        return acknowledge_key(robot)

    def look(self, request: Request | None, now_ns: int) -> None:
        """See OperatorDesk."""
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
        if not self._has_done(lambda node: node.acknowledge(), request):
            return
        self._say(f"acknowledges, asked for by `farhand acknowledge`: {state.reason}")
        self._reason, self._stops = state.reason, state.stops
        self._begun_ns, self._cleared_ns = now_ns, None

    def _follow(self, now_ns: int) -> None:
        node, state = self._node, self._node.state
        if node.clearing:
            if now_ns - self._begun_ns > GIVE_UP_NS:
                self._answer(refusal("the robot has not confirmed it; the operator's program goes on asking"))
        elif state is None or state.holder != node.session:
            self._answer(refusal("control was lost meanwhile"))
        elif state.mode in LATCHED:
            self._answer(refusal(still_stopped(state, self._stops)))
        elif self._cleared_ns is None:
            self._cleared_ns = now_ns
        elif now_ns - self._cleared_ns >= SETTLE_NS:
            self._answer(msgspec.json.encode({"ok": True, "cleared": self._reason}))


def acknowledge(robot: str, connect: Sequence[str], tls: str, router: bool = False) -> int:
    """`farhand acknowledge`: returns 0 once the robot has left its stop, 1 where it has not, which is said.

    Arguments and errors: see reach.reaching.
    """
    clock = SystemClock()
    with reaching("acknowledge", robot, connect, tls, router) as reached:
        clearing = Clearing(robot, reached.source, clock.now_ns() | 1)
        _pursue(clearing, reached.sessions, robot, clock)
    if clearing.refusal or not clearing.done:
        silent = (
            f"robot {robot!r} and its operator have not answered in {PATIENCE:g} s; tried {reached.tried}"
        )
        say("acknowledge", f"NOT CLEARED: {clearing.refusal or silent}")
        return 1
    print(f"{robot} has left its stop ({clearing.cleared}); it moves when who holds control drives it")
    return 0


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
