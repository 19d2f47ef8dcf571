"""What `farhand acknowledge` knows, sends and decides: a state machine that is told the time."""

import threading

import msgspec

from farhand.common.messages.base import ZERO
from farhand.common.messages.codec import Decoder, encode
from farhand.common.messages.command import CommandMode, VelocityCommand
from farhand.common.messages.echo import Newest
from farhand.common.messages.state import RobotState
from farhand.operator_side.supervision import holder_name

HELD_PATIENCE = 5.0
"""For the holder's program to be found and to answer, where the robot itself is heard (s)."""
SETTLE_NS = 500_000_000
"""A stop that is back within this time was not cleared."""
LATCHED = ("stopped", "estop")


def why_not(state: RobotState | None, session: int) -> str:
    """Why an operator cannot acknowledge what the robot shows; empty where it can.

    Args:
        state: the robot's newest.
        session: of the operator.
    """
    if state is None:
        return "nothing has come from the robot yet"
    if state.mode not in LATCHED:
        return f"there is nothing to acknowledge: robot {state.source!r} is in {state.mode} ({state.reason})"
    if state.holder != session:
        who = f"{holder_name(state)} does" if state.holder else "nobody does"
        return f"this operator does not hold control; {who}"
    return ""


def still_stopped(state: RobotState, stops: int) -> str:
    """Why an acknowledgement is over though the robot is in a stop.

    Args:
        state: the robot's newest.
        stops: its count of them when it was acknowledged.
    """
    if state.stops == stops:
        return f"it was acknowledged too early; the robot says now: {state.reason}"
    return f"the robot stopped again: {state.reason}"


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
        except (msgspec.MsgspecError, ValueError, RecursionError):
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
        if state.mode in LATCHED:
            self.cleared, self._left_ns = state.reason, None
        elif self._left_ns is None:
            self._left_ns = now_ns
        if self._refused_there:
            self._end(self._refused_there)
        elif state.mode not in LATCHED and not self.cleared:
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
        left = self._left_ns is not None
        if state.mode in LATCHED and (left or (state.stops, state.reason) != (self._stops, self.cleared)):
            self._end(still_stopped(state, self._stops))
            return self._command("release", now_ns)
        if state.mode in LATCHED:
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
