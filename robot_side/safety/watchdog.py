"""The safety state machine: which commands move the robot, and what happens when they stay away.

RUN -> HOLD (no good command within the timeout: the received plan is played out, then zero) -> STOPPED.
STOPPED and ESTOP are latched: only a fresh acknowledgement of the session in control leads out of them. Nothing that
is commanded moves a latched robot. In a stop that silence brought its own guard may still take it out of the way of
what moves, for a bounded time, and then until nothing comes: who is stopped in a mover's way is run over. Every other
stop stands at once.
It is told the robot's own time and compares no two clocks: a command's age is that of the robot's own
stamp that the command echoes.
"""

from collections import Counter, OrderedDict, deque
from collections.abc import Callable
from dataclasses import dataclass
from itertools import chain

from farhand.common.geometry import STILL, Twist, norm
from farhand.common.messages.base import SafetyMode
from farhand.common.messages.command import VelocityCommand
from farhand.common.messages.state import ESTOP_BY, FAULT
from farhand.common.timing.clock import to_ns
from farhand.robot_side.safety.lease import ControlLease
from farhand.robot_side.safety.plan import PlanPlayer
from farhand.robot_side.safety.settings import SafetySettings

REMEMBERED_SESSIONS = 64
REMEMBERED_CHANGES = 1000
ESTOP_ANEW_NS = 500_000_000
MOST_FAULT = 384
"""Letters: a reason has at most 512, and begins with who asked for an emergency stop."""
_LATCHED = ("stopped", "estop")


@dataclass(frozen=True, slots=True)
class ModeChange:
    """One entry of the watchdog's log: when (ns, robot clock), into which mode, and why."""

    t_ns: int
    mode: SafetyMode
    reason: str


class Watchdog:
    """Decides, command by command and tick by tick, what the robot may do.

    Who may command is said by the lease: a session gets it by a command that is built on a state of the robot
    which showed it free. An `acknowledge` of another session asks for it: it is refused as `held`, and shown.

    A `run` command is good if it comes from the session in control, is newer than the last one, echoes a
    message of this robot session that is at most `max_age` old, and is within `max_speed` and
    `max_angular_speed`. A `hold` needs no echo, since all it can do is brake; it keeps the connection alive. An
    `estop` is obeyed from anyone. An `acknowledge` clears only a stop that the state shows on which it is built:
    one already under way, or sent again, clears none that its sender has not seen.

    Args:
        settings: limits.
        session: the robot's own session, which echoes must name.

    Attributes:
        mode, reason: the state and why it was entered.
        refused: commands refused, by reason.
        newest_refused: name and session of the newest of them, by reason, for people.
        stops: entries into a latched stop.
        holds: times that RUN became HOLD because commands stayed away.
        changes: the last mode changes.
        first_run_ns: when it first ran; None: it never did.
        applied_session, applied_seq, applied_ns: the command now applied, and since when (robot clock).
    """

    def __init__(self, settings: SafetySettings, session: int) -> None:
        self._session = session
        self._max_age_ns = to_ns(settings.max_age)
        self._max_speed, self._max_angular_speed = settings.max_speed, settings.max_angular_speed
        self._command_timeout_ns = to_ns(settings.command_timeout)
        self._stop_timeout_ns = to_ns(settings.stop_timeout)
        self._evade_timeout_ns = to_ns(settings.evade_timeout)
        self._player = PlanPlayer()
        self._newest_seq: OrderedDict[int, int] = OrderedDict()
        self._estop_reason = ""
        self._estopped_by: dict[
            int, int
        ] = {}  # when it came last, by session, of the stop that is latched (ns)
        self._fault = self._blocked = ""  # of the stop that is latched
        self._stopped_ns = 0  # since when the latched stop is there
        self._evades_until_ns = 0  # until when at least the guard may move what is stopped; 0: it may not
        self._good_ns: int | None = None  # the last good command; None while nobody is expected to send
        self.lease = ControlLease(to_ns(settings.lease_timeout))
        self.mode: SafetyMode = "hold"
        self.reason = "waiting for an operator"
        self.refused: Counter[str] = Counter()
        self.newest_refused: dict[str, tuple[str, int]] = {}
        self.stops = 0
        self.holds = 0
        self.changes: deque[ModeChange] = deque(maxlen=REMEMBERED_CHANGES)
        self.first_run_ns: int | None = None
        self.applied_session = 0
        self.applied_seq = 0
        self.applied_ns = 0

    @property
    def latched(self) -> bool:
        """Whether only an acknowledgement leads on."""
        return self.mode in _LATCHED

    def stands(self, now_ns: int, comes: Callable[[], bool] = lambda: False) -> bool:
        """Whether the robot is to stand, whatever its guard would do: once it is, it does until this stop ends.

        Args:
            now_ns: robot clock.
            comes: whether something comes that the guard would have to take it out of the way of; asked only where
                the time for that is over.
        """
        if not self.latched or now_ns < self._evades_until_ns or (self._evades_until_ns and comes()):
            return False
        self._evades_until_ns = 0
        return True

    def twist(self, now_ns: int) -> Twist:
        """The twist of the tool that is allowed at `now_ns` (base)."""
        return STILL if self.mode in _LATCHED else self._player.twist(now_ns)

    def tick(self, now_ns: int) -> None:
        """Let time act: timeouts and the end of a lease."""
        silent_ns = 0 if self._good_ns is None else now_ns - self._good_ns
        if self.mode == "run" and silent_ns > self._command_timeout_ns:
            self.holds += 1
            self._enter("hold", f"no good command for {silent_ns * 1e-9:.3f} s", now_ns)
        if self.mode == "hold" and silent_ns > self._stop_timeout_ns:
            self._stop("stopped", f"no good command for {silent_ns * 1e-9:.3f} s", now_ns)
            if self._evade_timeout_ns:
                self._evades_until_ns = now_ns + self._evade_timeout_ns
        if self.lease.expire(now_ns) and not self.latched:
            self._rest("the holder of control fell silent", now_ns)

    def receive(self, command: VelocityCommand, now_ns: int) -> bool:
        """Judge one decoded command and obey it if it is good; whether it was obeyed."""
        if command.mode == "estop":
            self._stop_for(command, now_ns)
            return True
        refusal = self._judge(command, now_ns)
        if refusal:
            self.refused[refusal] += 1
            self.newest_refused[refusal] = command.source, command.session
            return False
        self._obey(command, now_ns)
        return True

    def in_control(self, command: VelocityCommand) -> bool:
        """Whether the command is from the session that holds control now."""
        return command.session == self.lease.holder != 0

    def fault(self, what: str, now_ns: int) -> None:
        """Something inside the robot failed: stop, and stay stopped. An emergency stop stays one, and says so too."""
        self._fault = f"{FAULT}{what}"[:MOST_FAULT]
        self._stop("estop" if self.mode == "estop" else "stopped", self._why(), now_ns)

    def block(self, why: str, now_ns: int) -> None:
        """The robot itself says that it cannot move: stopped, by what it says now; called for as long as it says so.

        Only an acknowledgement that is built on a state from after the last call leads on. What it says is the
        reason, after that of an emergency stop: an acknowledgement counts for the reason that was seen.
        """
        self._blocked = why
        self._stop("estop" if self.mode == "estop" else "stopped", self._why(), now_ns)
        self._stopped_ns = now_ns

    def _stop_for(self, command: VelocityCommand, now_ns: int) -> None:
        """An emergency stop of whoever it is. Sent on by the same session it is the same one.

        Of another session, or after a pause, it is a new one: an acknowledgement under way has not seen it.
        """
        if command.session == self.lease.holder and not self._is_old(command):
            self._note_seq(command)  # what its sender sent before is no answer to it
        before, came_ns = len(self._estopped_by), self._estopped_by.get(command.session)
        if self.mode != "estop" or (came_ns is None and before < REMEMBERED_SESSIONS):
            self._estop_reason = f"{ESTOP_BY}{command.source}" + (
                f", and by {before} before" if before else ""
            )
            self._stop("estop", self._why(), now_ns)
        elif came_ns is None or now_ns - came_ns > ESTOP_ANEW_NS:
            self._stopped_ns = now_ns  # one of too many, or the same sender again
        if came_ns is not None or before < REMEMBERED_SESSIONS:
            self._estopped_by[command.session] = now_ns

    def _why(self) -> str:
        """All reasons of the stop that is latched, the emergency stop first."""
        return "; ".join(filter(None, (self._estop_reason, self._fault, self._blocked)))[:512]

    def _judge(self, command: VelocityCommand, now_ns: int) -> str:
        """Why the command is refused, or an empty string. Grants and renews the lease on the way."""
        lease, free = self.lease, self.lease.holder == 0
        if not free and command.session != lease.holder:
            return self._judge_outsider(command, now_ns)
        if self._is_old(command):
            return "old-seq"
        if free and command.mode == "release":
            return "late-release"
        unfit = self._unfitness(command, now_ns)
        if free and unfit:
            return unfit
        lease.grant(command.session, command.source, now_ns)
        self._note_seq(command)
        return self._judge_holder(command, unfit, now_ns)

    def _judge_holder(self, command: VelocityCommand, unfit: str, now_ns: int) -> str:
        """Why a command of the one in control is refused; standing still is never refused."""
        if command.mode == "hold" or (command.mode == "release" and not command.successor):
            return ""
        if unfit:
            return unfit
        if command.mode == "release":
            return "" if self.lease.waits(command.successor, now_ns) else "no-successor"
        if command.mode == "acknowledge":
            return "unseen-stop" if self.latched and self._is_before_stop(command) else ""
        if command.mode != "run":
            return ""
        if self.latched:
            return "stopped"
        if _fastest(command) > self._max_speed:
            return "too-fast"
        return "turns-too-fast" if _fastest_turn(command) > self._max_angular_speed else ""

    def _unfitness(self, command: VelocityCommand, now_ns: int) -> str:
        """Why the command must not move anything, or an empty string."""
        stale = self._staleness(command, now_ns)
        return stale or (_outside(command) if self._unaware(command) else "")

    def _judge_outsider(self, command: VelocityCommand, now_ns: int) -> str:
        """Why a command from outside the lease is refused; who asks for control properly is remembered."""
        if command.mode != "acknowledge":
            return _outside(command)
        if self._is_old(command):
            return "old-seq"
        stale = self._staleness(command, now_ns)
        if stale:
            return stale
        known = self.lease.ask(command.session, command.source, command.seq, now_ns)
        return _outside(command) if known else "old-seq"

    def _is_old(self, command: VelocityCommand) -> bool:
        return command.seq <= self._newest_seq.get(command.session, -1)

    def _unaware(self, command: VelocityCommand) -> bool:
        """Whether its sender had not yet seen that control had become free, or its own.

        Without this a request under way, repeated without anybody's doing, would take control of a lease that
        ended by silence, or clear a stop for the one who was handed control.
        """
        return command.echo is not None and command.echo.t_sent_ns < self.lease.since_ns

    def _is_before_stop(self, command: VelocityCommand) -> bool:
        return command.echo is not None and command.echo.t_sent_ns < self._stopped_ns

    def _staleness(self, command: VelocityCommand, now_ns: int) -> str:
        """Why the command is not built on a recent state of this robot session, or an empty string."""
        if command.echo is None:
            return "no-echo"
        if command.echo.session != self._session:
            return "foreign-echo"
        age_ns = now_ns - command.echo.t_sent_ns
        return "" if 0 <= age_ns <= self._max_age_ns else "stale"

    def _note_seq(self, command: VelocityCommand) -> None:
        self._newest_seq[command.session] = command.seq
        self._newest_seq.move_to_end(command.session)
        if len(self._newest_seq) > REMEMBERED_SESSIONS:
            self._newest_seq.popitem(last=False)

    def _obey(self, command: VelocityCommand, now_ns: int) -> None:
        if command.mode == "release":
            self._release(command.successor, now_ns)
            return
        if command.mode == "hold" and self.latched:
            return
        self.applied_session, self.applied_seq, self.applied_ns = command.session, command.seq, now_ns
        self._good_ns = now_ns
        if command.mode == "run":
            self._player.load(command, now_ns)
            self._enter("run", "commanded", now_ns)
            return
        self._player.clear()
        reason = "held by the operator" if command.mode == "hold" else "acknowledged"
        self._enter("hold", reason, now_ns)

    def _release(self, successor: int, now_ns: int) -> None:
        """End the lease, or pass it on. A latched stop stays."""
        reason = "control was released"
        if successor:
            self.lease.hand_over(successor, now_ns)
            reason = f"control was handed over to {self.lease.holder_name}"
        else:
            self.lease.release(now_ns)
        if not self.latched:
            self._rest(reason, now_ns)

    def _rest(self, reason: str, now_ns: int) -> None:
        """Zero velocity, and nobody is expected to send."""
        self._player.clear()
        self._good_ns = None
        self._enter("hold", reason, now_ns)

    def _stop(self, mode: SafetyMode, reason: str, now_ns: int) -> None:
        self._player.clear()
        self._evades_until_ns = 0
        if not self.latched:
            self.stops += 1
        if (mode, reason) != (self.mode, self.reason):
            self._stopped_ns = (
                now_ns  # the same again is the same stop; anything else has not been seen before
            )
        self._enter(mode, reason, now_ns)

    def _enter(self, mode: SafetyMode, reason: str, now_ns: int) -> None:
        if (mode, reason) == (self.mode, self.reason):
            return
        if mode not in _LATCHED:  # the next stop has reasons of its own
            self._estopped_by.clear()
            self._estop_reason = self._fault = self._blocked = ""
        self.mode, self.reason = mode, reason
        self.changes.append(ModeChange(now_ns, mode, reason))
        if mode == "run" and self.first_run_ns is None:
            self.first_run_ns = now_ns


def _outside(command: VelocityCommand) -> str:
    """The reason to refuse what comes from outside the lease."""
    if command.mode == "release":
        return "late-release"
    return "held" if command.mode == "acknowledge" else "foreign-session"


def _fastest(command: VelocityCommand) -> float:
    """Largest magnitude in any axis of the velocity and of its plan (m/s)."""
    return max(map(abs, chain(command.velocity, *command.plan)))


def _fastest_turn(command: VelocityCommand) -> float:
    """Largest magnitude of the angular velocity and of its plan (rad/s)."""
    return max(map(norm, (command.angular, *command.plan_angular)))
