"""What mode the next command has: the operator's half of the safety state machine, one decision a tick.

| situation | command |
|---|---|
| the device's emergency stop | estop |
| somebody's on this host, until the robot has latched it | estop |
| no state, no scene or no description yet | nothing is sent |
| two robots of this name send states | hold |
| another session holds control | acknowledge, once a second, which asks for it and is refused |
| this session waited, control is free but was not released, the operator acknowledges | acknowledge |
| the same, the operator does not acknowledge | nothing is sent |
| the operator hands control over to one that waits | release, with the successor |
| the robot is stopped and the operator acknowledges, or somebody on this host | acknowledge |
| the robot is stopped or estopped | hold |
| nobody holds control | acknowledge, which asks for it |
| the device is not engaged | hold |
| otherwise | run |

So control that its holder gave up is taken by itself, and so is control that was this operator's own (by name:
it lost its link, or was restarted). Control that another one lost in silence, or with the robot's restart, is
taken only if a person decides it.
"""

from dataclasses import dataclass, replace

from farhand.common.messages.base import SafetyMode
from farhand.common.messages.command import CommandMode
from farhand.common.messages.state import RobotState
from farhand.operator_side.steering.device import SteeringInput
from farhand.operator_side.steering.first_seen import ESTOP_AT_LEAST_NS, FirstSeen

NOT_ENGAGED = "device not engaged"
"""What is said of a device that holds nothing down."""
ASK_PERIOD_NS = 1_000_000_000
ESTOP_ASKED = "emergency stop, asked for by `farhand estop`"
_TWINS = "two robots call themselves {!r}; end one, or give it another --robot"


@dataclass(frozen=True, slots=True)
class Decision:
    """Attributes:
    mode: of the command; None: send nothing.
    reason: why it is not `run`, empty for `run`.
    successor: who gets control with a `release`.
    asking: whether the command only asks for what another one holds: nothing answers it.
    """

    mode: CommandMode | None
    reason: str = ""
    successor: int = 0
    asking: bool = False


@dataclass(frozen=True, slots=True)
class Seat:
    """An operator before the robot.

    Attributes:
        session, name: its own.
        waited_for: name of the other one that held control last, as far as this session has seen; empty after
            it held control itself.
        successor: the session that it wants to hand over to; 0: none.
    """

    session: int
    name: str = "operator"
    waited_for: str = ""
    successor: int = 0


def decide(state: RobotState | None, lacking: str, steering: SteeringInput | None, me: Seat) -> Decision:
    """The table above, first match first.

    Args:
        state: newest from the robot, if any.
        lacking: what has not come from the robot yet; empty: nothing is lacking.
        steering: what the device wants; None while something is lacking.
        me: this operator.
    """
    if steering is not None and steering.estop:
        return Decision("estop", "emergency stop by the operator")
    if state is None or steering is None:
        return Decision(None, f"no {lacking or 'state'} from the robot yet")
    if state.holder not in (0, me.session):
        return Decision("acknowledge", _waiting(state, me), asking=True)
    if state.holder == 0 and me.waited_for and state.lease_end != "released":
        mode: CommandMode | None = "acknowledge" if steering.acknowledge else None
        return Decision(mode, f"{me.waited_for} lost control without releasing it; acknowledge to take it")
    if state.holder == me.session and me.successor:
        name = dict(state.waiting).get(me.successor, "")
        return Decision("release", f"handing control over to {name}", me.successor)
    if state.mode in ("stopped", "estop"):
        if steering.acknowledge:
            return Decision("acknowledge", f"acknowledging: {state.reason}")
        says = f"; {steering.says}" if steering.says else ""
        return Decision("hold", f"robot {state.mode}: {state.reason}{says}")
    if state.holder == 0:
        return Decision("acknowledge", "asking for control")
    if not steering.engaged:
        return Decision("hold", NOT_ENGAGED)
    return Decision("run")


def holder_name(state: RobotState) -> str:
    """Who holds control, for people."""
    return state.holder_name or f"session {state.holder:x}"


def _waiting(state: RobotState, me: Seat) -> str:
    return (
        f"{holder_name(state)} holds control; waiting; it can hand over to you with "
        f"`farhand handover --to {me.name} --robot {state.source}`"
    )


class Supervision:
    """`decide`, with what it must remember from tick to tick.

    Args:
        session, name: of this operator.

    Attributes:
        successor: the session to hand over to; 0: none.
        twins: whether two robots of one name send states.
        estop: whether an emergency stop was asked for that the robot has not confirmed yet.
        clearing: the robot's mode, its count of stops and its reason, of the one stop that somebody asked to be
            acknowledged; None: nobody did, or it is over, or has another reason.
    """

    def __init__(self, session: int, name: str) -> None:
        self.session, self._name = session, name
        self._waited_for = ""
        self._asked_ns: int | None = None
        self.successor = 0
        self.twins = False
        self.estop = False
        self._estop_ns: int | None = None  # since when it is sent; None: from the next tick on
        self._seen = FirstSeen()
        self._outdated = False  # the device still acknowledges what was there before an emergency stop
        self.clearing: tuple[SafetyMode, int, str] | None = None

    def stop(self) -> None:
        """Send emergency stops until the robot has latched one of them. Nothing is acknowledged any more."""
        if not self.estop:
            self._estop_ns = None
        self.estop, self.clearing, self._outdated = True, None, True

    def clear(self, state: RobotState) -> None:
        """Acknowledge the stop that `state` shows, and no later one, until the robot has left it."""
        self.clearing = state.mode, state.stops, state.reason

    def step(
        self, state: RobotState | None, lacking: str, steering: SteeringInput | None, now_ns: int
    ) -> Decision:
        """The decision of a tick."""
        if state is not None:
            self._look(state)
        if steering is not None:
            steering = self._up_to_date(steering)
        self.confirm(state, now_ns)
        if self.estop:
            return Decision("estop", ESTOP_ASKED)
        if self.clearing is not None and steering is not None:
            steering = replace(steering, acknowledge=True)
        me = Seat(self.session, self._name, self._waited_for, self.successor)
        decision = decide(state, lacking, steering, me)
        if state is not None and self.twins and decision.mode not in (None, "estop"):
            return Decision("hold", _TWINS.format(state.source))
        if not decision.asking:
            return decision
        if self._asked_ns is not None and now_ns - self._asked_ns < ASK_PERIOD_NS:
            return Decision(None, decision.reason)
        self._asked_ns = now_ns
        return decision

    def confirm(self, state: RobotState | None, now_ns: int) -> None:
        """Look whether the robot has latched the emergency stop that is sent: then an acknowledgement counts again."""
        if not self.estop:
            return
        if self._estop_ns is None:
            self._estop_ns = now_ns
        if state is not None and self._has_latched(state, self._estop_ns, self._seen.look(state, now_ns)):
            self.estop = False

    def _up_to_date(self, steering: SteeringInput) -> SteeringInput:
        """What the device wants, without an acknowledgement that was given before an emergency stop."""
        if steering.estop:
            self.clearing = None
        self._outdated = self._outdated and steering.acknowledge
        return replace(steering, acknowledge=False) if self._outdated else steering

    def _has_latched(self, state: RobotState, since_ns: int, seen_ns: int) -> bool:
        """Whether the robot shows a stop of ours: one that it showed before may be over by what is under way to it."""
        if state.mode != "estop":
            return False
        if state.holder == self.session:
            echo = state.echo
            return echo is not None and echo.session == self.session and echo.t_sent_ns >= since_ns
        return seen_ns - since_ns >= ESTOP_AT_LEAST_NS  # it echoes nobody but who is in control

    def _look(self, state: RobotState) -> None:
        """Note whom this session waits for, and whether a handover or an acknowledgement is over."""
        if state.holder == self.session:
            self._waited_for = ""
        elif state.holder and state.holder_name != self._name:
            self._waited_for = holder_name(state)
        if state.holder != self.session or self.successor not in dict(state.waiting):
            self.successor = 0
        if state.holder != self.session or (state.mode, state.stops, state.reason) != self.clearing:
            self.clearing = None
