"""An emergency stop from anyone who may command: through an operator's program, or straight to the robot or the
emulator's side for operators.

The robot obeys an emergency stop whoever holds control, and latches it: only an acknowledgement of the one in
control leads out of it.
"""

import secrets
import threading
from collections.abc import Sequence

import msgspec
import zenoh

from farhand.common.link.requests import Request, refusal
from farhand.common.messages.codec import Decoder, encode
from farhand.common.messages.command import VelocityCommand
from farhand.common.messages.keys import command_key, estop_key, state_key
from farhand.common.messages.state import ESTOP_BY, RobotState
from farhand.common.process.signals import say
from farhand.common.timing.clock import SystemClock, to_ns
from farhand.site.desk import GIVE_UP_NS, OperatorDesk
from farhand.site.reach import reaching

PATIENCE = 5.0
AGAIN_AFTER = 0.1
MOST_NAME = 50
"""Letters of who asks: a name has at most 64."""
AT_LEAST = 3.0
"""s: for so long it is sent where the robot shows the emergency stop of another one."""


class EstopServer(OperatorDesk):
    """The operator's half of `farhand estop`."""

    name = "estop"
    _give_up_ns = 0

    @staticmethod
    def key(robot: str) -> str:
        """See OperatorDesk."""
        return estop_key(robot)

    def look(self, request: Request | None, now_ns: int) -> None:
        """See OperatorDesk."""
        if request is not None and self._has_done(lambda node: node.emergency_stop(), request):
            if len(self._pending) == 1:  # it asks again and again until it is confirmed
                self._say("emergency stop, asked for by `farhand estop`")
            self._give_up_ns = now_ns + GIVE_UP_NS
        if not self._pending:
            return
        if not self._node.stopping:
            self._answer(msgspec.json.encode({"ok": True}))
        elif now_ns > self._give_up_ns:
            self._answer(refusal("the robot has not confirmed it; the operator's program goes on sending it"))


def emergency_stop(robot: str, connect: Sequence[str], tls: str, router: bool = False) -> int:
    """`farhand estop`: returns 0 once the robot has latched it, 1 where nobody confirms it in 5 s.

    Arguments and errors: see reach.reaching.
    """
    with reaching("estop", robot, connect, tls, router) as reached:
        reason = _Stop(robot, reached.source).send(reached.sessions, PATIENCE)
    if reason is None:
        why = f"robot {robot!r} has not said in {PATIENCE:g} s that it stopped; tried {reached.tried}"
        say("estop", f"NOT CONFIRMED: {why}")
        return 1
    print(
        f"{robot} is stopped ({reason}); only an acknowledgement leads out of it: at the device of who holds "
        f"control, or `farhand acknowledge --robot {robot}`"
    )
    return 0


class _Stop:
    """Sends emergency stops until one is confirmed.

    Args:
        robot: whom to stop.
        source: who wants it, for the robot's reason.
    """

    def __init__(self, robot: str, source: str) -> None:
        # no other stop is named so: neither an earlier one of the same person, nor one of an operator's program of his
        self._robot, self._source = robot, f"{source[:MOST_NAME]} (call {secrets.token_hex(2)})"
        self._done = threading.Event()
        self._reason = ""
        self._decoder = Decoder(RobotState)
        self._sent_ns: int | None = None
        self._clock = SystemClock()

    def send(self, sessions: Sequence[zenoh.Session], patience: float) -> str | None:
        """The robot's reason once it has stopped; None if nobody confirms it for `patience` s."""
        clock = self._clock
        me, start_ns, seq = clock.now_ns() | 1, clock.now_ns(), 0
        self._sent_ns = start_ns
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
        if state is None or state.mode != "estop" or self._sent_ns is None:
            return
        # another one that was there before may be over by an acknowledgement that is under way to the robot
        ours = state.reason.startswith(f"{ESTOP_BY}{self._source}")
        if ours or self._clock.now_ns() - self._sent_ns > to_ns(AT_LEAST):
            self._settle(state.reason)

    def _hear(self, reply: zenoh.Reply) -> None:
        if reply.ok is not None and b'"ok":true' in reply.ok.payload.to_bytes():
            self._settle("by its operator's program")

    def _settle(self, reason: str) -> None:
        if not self._done.is_set():
            self._reason = reason
            self._done.set()
