"""An emergency stop from anyone who may command: through an operator's program, or straight to the robot or the
emulator's side for operators.

The robot obeys an emergency stop whoever holds control, and latches it: only an acknowledgement of the one in
control leads out of it.
"""

import threading
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from typing import TYPE_CHECKING

import msgspec
import zenoh

from farhand.common.errors import InputError
from farhand.common.link.requests import Desk, Request, Requests, refusal
from farhand.common.link.zenoh_link import open_session
from farhand.common.messages.codec import Decoder, encode
from farhand.common.messages.command import VelocityCommand
from farhand.common.messages.keys import check_robot_name, command_key, estop_key, state_key
from farhand.common.messages.state import RobotState
from farhand.common.process.security import Access, local_endpoint, secure, tool_place
from farhand.common.process.signals import say
from farhand.common.timing.clock import SystemClock, to_ns
from farhand.common.timing.slot import NotServedError, Slot
from farhand.common.trust.tls import TlsFolder
from farhand.site.operator_name import operator_name

if TYPE_CHECKING:
    from farhand.operator_side.operator_node import OperatorNode

REPORT_ENDPOINT = "tcp/127.0.0.1:7446"
PATIENCE = 5.0
AGAIN_AFTER = 0.1
GIVE_UP_NS = 4_000_000_000
_MAY_COMMAND = ("operator", "netem", "router")


class EstopServer:
    """The operator's half of `farhand estop`, in a thread of its own; it changes the node through the slot alone.

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
        self._give_up_ns = 0
        requests = Requests(session, estop_key(robot))
        self._desk = Desk("estop", lambda request: self.look(request, clock.now_ns()), requests)

    def close(self) -> None:
        """Look no more."""
        self._desk.close()

    def look(self, request: Request | None, now_ns: int) -> None:
        """Begin with a request if one has come, and answer those that are settled."""
        if request is not None:
            self._begin(request, now_ns)
        if not self._pending:
            return
        if not self._node.stopping:
            self._answer(msgspec.json.encode({"ok": True}))
        elif now_ns > self._give_up_ns:
            self._answer(refusal("the robot has not confirmed it; the operator's program goes on sending it"))

    def _begin(self, request: Request, now_ns: int) -> None:
        try:
            self._slot.do(lambda _: self._node.emergency_stop())
        except NotServedError as error:
            request.reply(refusal(str(error)))
            return
        self._say("emergency stop, asked for by `farhand estop`")
        self._pending.append(request)
        self._give_up_ns = now_ns + GIVE_UP_NS

    def _answer(self, answer: bytes) -> None:
        for request in self._pending:
            request.reply(answer)
        self._pending.clear()


def emergency_stop(robot: str, connect: Sequence[str], tls: str, router: bool = False) -> int:
    """`farhand estop`: returns 0 once the robot has latched it, 1 where nobody confirms it in 5 s.

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
    folder = secure(Access(connect=ends, tls=tls), lambda line: say("estop", line))
    if folder is not None:
        check_rights(folder, robot)
    stop = _Stop(robot, operator_name("", folder))
    with ExitStack() as closing:
        extra = folder.settings(tool_place(folder)) if folder else ()
        sessions = [open_session(ends, mode="client" if router else "peer", extra=extra)]
        if not connect:
            sessions.append(open_session([REPORT_ENDPOINT]))
        for session in sessions:
            closing.callback(session.close)
        reason = stop.send(sessions, PATIENCE)
    if reason is None:
        tried = ", ".join([*ends, *([REPORT_ENDPOINT] if not connect else [])])
        say(
            "estop",
            f"NOT CONFIRMED: robot {robot!r} has not said in {PATIENCE:g} s that it stopped; tried {tried}",
        )
        return 1
    print(
        f"{robot} is stopped ({reason}); only an acknowledgement leads out of it: at the device of who holds "
        f"control, or `farhand acknowledge --robot {robot}`"
    )
    return 0


def check_rights(folder: TlsFolder, robot: str) -> None:
    """Raise InputError where a certificate must not command a robot: the other end would drop it in silence."""
    own = folder.own
    if own.role not in _MAY_COMMAND:
        raise InputError(f"--tls: certificate {own.name!r} has the role {own.role}, which must not command; "
                         "take an operator's")  # fmt: skip
    if own.robots and robot not in own.robots:
        raise InputError(f"--robot {robot!r}: certificate {own.name!r} is for {', '.join(own.robots)}")


class _Stop:
    """Sends emergency stops until one is confirmed.

    Args:
        robot: whom to stop.
        source: who wants it, for the robot's reason.
    """

    def __init__(self, robot: str, source: str) -> None:
        self._robot, self._source = robot, source
        self._done = threading.Event()
        self._reason = ""
        self._decoder = Decoder(RobotState)

    def send(self, sessions: Sequence[zenoh.Session], patience: float) -> str | None:
        """The robot's reason once it has stopped; None if nobody confirms it for `patience` s."""
        clock = SystemClock()
        me, start_ns, seq = clock.now_ns() | 1, clock.now_ns(), 0
        for session in sessions:
            session.declare_subscriber(state_key(self._robot), self._see)
        asked = 2  # the sessions need a moment to connect
        while clock.now_ns() - start_ns < to_ns(patience):
            command = VelocityCommand(
                source=self._source,
                session=me,
                seq=seq,
                t_sent_ns=clock.now_ns(),
                mode="estop",
                velocity=(0.0, 0.0, 0.0),
            )
            for session in sessions:
                session.put(command_key(self._robot), encode(command), express=True,
                            priority=zenoh.Priority.REAL_TIME)  # fmt: skip
                if seq == asked:  # an operator's program, should one be there, goes on by itself
                    session.get(estop_key(self._robot), self._hear, timeout=patience, payload=b"{}")
            asked = seq + 10 if seq == asked else asked
            seq += 1
            if self._done.wait(AGAIN_AFTER):
                return self._reason
        return None

    def _see(self, sample: zenoh.Sample) -> None:
        state = self._decoder.decode(sample.payload.to_bytes())
        if state is not None and state.mode == "estop":
            self._settle(state.reason)

    def _hear(self, reply: zenoh.Reply) -> None:
        if reply.ok is not None and b'"ok":true' in reply.ok.payload.to_bytes():
            self._settle("by its operator's program")

    def _settle(self, reason: str) -> None:
        if not self._done.is_set():
            self._reason = reason
            self._done.set()
