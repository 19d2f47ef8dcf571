"""What a stamp of the robot's clock means on the console's own, by stamps that were echoed: bounds, never a guess.

A command that left the operator at o was at the robot at r, as the state that echoes it says; so the operator's clock
showed at least o when the robot's showed r. A state that left the robot at r' was at the operator at o', as the
command that echoes it says; so the operator's showed at most o' when the robot's showed r'. With θ the operator's
clock less the robot's: max (o − r) <= θ <= min (o' − r'), and what lies between is the least round trip.

The hop between operator and console, two programs on one host, is the one thing that is not counted: by as much as the
quickest report of the last seconds took are ages told too young.
"""

from farhand.common.messages.report import ControlReport
from farhand.operator_side.console.picture import Picture

WINDOW_NS = 10_000_000_000
"""After twice this long a bound is forgotten, since clocks drift (20 ppm: 0.4 ms)."""


class _Largest:
    """The largest of the last 10 to 20 s."""

    def __init__(self) -> None:
        self._since_ns = 0
        self._now: int | None = None
        self._before: int | None = None

    def add(self, value: int, now_ns: int) -> None:
        if now_ns - self._since_ns > WINDOW_NS:
            stale = now_ns - self._since_ns > 2 * WINDOW_NS
            self._since_ns, self._before, self._now = now_ns, None if stale else self._now, None
        self._now = value if self._now is None else max(value, self._now)

    def value(self) -> int | None:
        both = [each for each in (self._now, self._before) if each is not None]
        return max(both, default=None)


class Stamps:
    """Told of what comes, a few dozen times a second."""

    def __init__(self) -> None:
        self._robot = self._operator = 0
        self._forget()

    def look(self, picture: Picture, now_ns: int) -> None:
        """Learn from the newest report, command and state; `now_ns` is the console's clock."""
        report, state, command = picture.report, picture.state, picture.command
        if report is None or state is None:
            return
        if (state.session, report.session) != (self._robot, self._operator):
            self._robot, self._operator = state.session, report.session
            self._forget()
        self._learn_now(report, picture.ages(now_ns)[0], now_ns)
        there = state.echo
        if there is not None and there.session == self._operator:
            self._least.add(there.t_sent_ns - (state.t_sent_ns - there.hold_ns), now_ns)
        here = command.echo if command is not None and command.session == self._operator else None
        if command is not None and here is not None and here.session == self._robot:
            self._most.add(here.t_sent_ns - (command.t_sent_ns - here.hold_ns), now_ns)

    def ages(self, session: int, stamp_ns: int, now_ns: int) -> tuple[float, float] | None:
        """At least and at most how old what a robot's session stamped is now (s); None where it cannot be told."""
        ahead, least, most = self._ahead.value(), self._least.value(), self._most.value()
        if not session or session != self._robot or ahead is None or least is None or most is None:
            return None
        since_ns = now_ns + ahead - stamp_ns
        return max(0.0, (since_ns + most) * 1e-9), max(0.0, (since_ns - least) * 1e-9)

    def _learn_now(self, report: ControlReport, age: float, now_ns: int) -> None:
        """How far ahead of the console's clock the operator's is, at least."""
        self._ahead.add(report.t_sent_ns - (now_ns - round(age * 1e9)), now_ns)

    def _forget(self) -> None:
        self._ahead, self._least, self._most = _Largest(), _Largest(), _Largest()
