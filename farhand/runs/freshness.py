"""What may be shown of an operator and its robot that were heard of some time ago.

Ages are counted where they are read, by what has arrived. A sender may say that its news are old; it cannot say
that they are new: one that has died would say so for ever.

| age | what is shown |
|---|---|
| nothing came yet | what is waited for |
| up to 1 s | live |
| up to 3 s | dimmed, with its age |
| beyond | what is gone; nothing is coloured as live, and the clock stands |
"""

from dataclasses import dataclass
from enum import Enum

from farhand.common.messages.report import ControlReport

OLD_AFTER = 1.0
GONE_AFTER = 3.0


class Freshness(Enum):
    """How new something is."""

    WAITING = "waiting"
    LIVE = "live"
    OLD = "old"
    GONE = "gone"


def freshness(age: float | None) -> Freshness:
    """Of what is `age` s old; None: it never came."""
    if age is None:
        return Freshness.WAITING
    if age <= OLD_AFTER:
        return Freshness.LIVE
    return Freshness.OLD if age <= GONE_AFTER else Freshness.GONE


@dataclass(frozen=True, slots=True)
class Ages:
    """Attributes:
    report: since the newest report came (s); None: none came.
    state: since the operator had the robot's newest state (s), at least `report`; None: it never had any.
    """

    report: float | None = None
    state: float | None = None


@dataclass(frozen=True, slots=True)
class Picture:
    """What may be shown.

    Attributes:
        operator: what the operator says of itself: its filter, its margin.
        robot: what it says of the robot; never newer than the operator.
        said: what people must be told; empty where all is live.
        ended: the operator is silent since it said that it ends.
    """

    operator: Freshness
    robot: Freshness
    said: str
    ended: bool = False

    @property
    def running(self) -> bool:
        """Whether operator and robot are both live: then alone the clock runs."""
        return self.operator is Freshness.LIVE and self.robot is Freshness.LIVE


def picture(ages: Ages, *, connected: bool = True, robot_connected: bool = True) -> Picture:
    """What may be shown at these ages.

    Args:
        ages: counted by the reader.
        connected: whether the reader is connected to the operator's program.
        robot_connected: whether the operator's program is connected to anything on the robot's side.
    """
    operator, robot = freshness(ages.report), freshness(ages.state)
    if ages.report is None:
        return Picture(operator, Freshness.WAITING, _waiting(connected))
    if operator is not Freshness.LIVE:
        if robot is Freshness.LIVE:
            robot = operator
        return Picture(operator, robot, _silent(operator, ages.report, connected))
    if robot is Freshness.LIVE:
        return Picture(operator, robot, "")
    return Picture(operator, robot, _unseen(robot, ages.state, robot_connected))


def _waiting(connected: bool) -> str:
    if connected:
        return "waiting for the operator's first report"
    return "waiting for the operator: nobody is connected yet"


def _silent(operator: Freshness, age: float, connected: bool) -> str:
    if operator is Freshness.OLD:
        return f"no report from the operator for {age:.1f} s"
    how = "it does not answer" if connected else "the connection is lost"
    return f"OPERATOR GONE: no report for {age:.1f} s, {how}; robot not seen"


def _ended(report: ControlReport, age: float) -> str:
    """How it ended, by its last report."""
    count = report.target_count
    how = "ended"
    if count:
        how = (
            f"finished, all {count} targets"
            if report.target_index >= count
            else "ended before the last target"
        )
    return f"the operator {how}: it gave control up {age:.1f} s ago"


def _unseen(robot: Freshness, age: float | None, robot_connected: bool) -> str:
    if age is None:
        where = "" if robot_connected else "; the operator is connected to nobody"
        return f"waiting for the robot's first state{where}"
    if robot is Freshness.OLD:
        return f"no state from the robot for {age:.1f} s"
    if not robot_connected:
        return f"ROBOT AND NETWORK GONE: no state for {age:.1f} s, nobody is connected"
    return f"ROBOT GONE: no state for {age:.1f} s; it, or the network on the way, is silent"


class Hearing:
    """Notes when news came, on the reader's own clock.

    Attributes:
        report: the newest; None before the first.
        released: session of an operator that gave control up to nobody, as it does when it ends; 0: none did.
    """

    def __init__(self) -> None:
        self.report: ControlReport | None = None
        self.released = 0
        self._report_ns = 0
        self._state_ns: int | None = None

    def take(self, report: ControlReport, now_ns: int) -> bool:
        """Note a report that came at `now_ns`; False for one that is not new, which refreshes nothing."""
        last = self.report
        same = last is not None and report.session == last.session
        if last is not None and same and report.tick <= last.tick:
            return False
        if report.safety is None:
            self._state_ns = None
        elif last is None or not same or last.safety is None or report.states > last.states:
            self._state_ns = now_ns - max(0, round(report.state_age * 1e9))
        self.report, self._report_ns = report, now_ns
        return True

    def ages(self, now_ns: int) -> Ages:
        """How old the news are at `now_ns`."""
        if self.report is None:
            return Ages()
        report = max(0.0, (now_ns - self._report_ns) * 1e-9)
        if self._state_ns is None:
            return Ages(report)
        return Ages(report, max(report, (now_ns - self._state_ns) * 1e-9))

    def picture(self, now_ns: int, connected: bool = True) -> Picture:
        """What may be shown at `now_ns`."""
        robot_connected = self.report is None or self.report.connected
        ages = self.ages(now_ns)
        found = picture(ages, connected=connected, robot_connected=robot_connected)
        report, silent = self.report, found.operator in (Freshness.OLD, Freshness.GONE)
        if report is None or ages.report is None or not silent or report.session != self.released:
            return found
        return Picture(Freshness.GONE, Freshness.GONE, _ended(report, ages.report), ended=True)
