"""A committed step to the side for those who drive straight on: out of the dead ends in which a filter alone stands.

A filter changes a wish as little as it can, so that in front of what is straight ahead it stands. Then the wish is
turned to the side that needs less of it, and kept there until the robot is past: who decides anew each tick swings to
and fro. The wish is turned before the filter, which judges it like any other.
"""

from dataclasses import dataclass

from farhand.common.geometry import norm
from farhand.common.messages.base import Vector3
from farhand.operator_side.steering.sides import (
    ANGLES,
    OTHER,
    STEP,
    Free,
    fan,
    towards,
    turned_towards,
    way_round,
)

SLOW = 0.2
"""Share of the wanted speed under which the robot makes no progress."""
PATIENCE_NS = 600_000_000
PAST = 0.05
"""A step ends this far beyond its start, along the way that was wanted there (m)."""
LONGEST_NS = 15_000_000_000
"""After this long the other side is tried."""
GROW_NS = 90_000_000
"""Who stands all the same turns by STEP more, and not sooner again than after this."""

NOTHING = 1e-9
"""m/s: a wish that is slower is none, and points nowhere."""


@dataclass(frozen=True, slots=True)
class Instant:
    """What a decision looks at.

    Attributes:
        now_ns: beginning of the tick.
        position, velocity: of the tool (m, m/s).
        free: see sides.Free.
    """

    now_ns: int
    position: Vector3
    velocity: Vector3
    free: Free


class Progress:
    """For how long a robot has made less than SLOW of the progress that was wanted."""

    def __init__(self) -> None:
        self._since_ns: int | None = None

    def lacking(self, wanted: Vector3, velocity: Vector3, now_ns: int) -> bool:
        """Whether it has for more than 0.6 s.

        Args:
            wanted, velocity: what is wanted and how the tool moves (m/s).
            now_ns: beginning of the tick.
        """
        speed = norm(wanted)
        made = sum(u * v for u, v in zip(wanted, velocity, strict=True))
        if speed < NOTHING or made >= SLOW * speed**2:
            self._since_ns = None
            return False
        if self._since_ns is None:
            self._since_ns = now_ns
        return now_ns - self._since_ns >= PATIENCE_NS

    def reset(self) -> None:
        """Begin anew."""
        self._since_ns = None


@dataclass(slots=True)
class _Step:
    """The step under way: its start, what was wanted there, the side, its unit vector, the angle (rad), since when, and
    when the angle grew last because the robot stood."""

    start: Vector3
    wanted: Vector3
    side: str
    across: Vector3
    angle: float
    since_ns: int
    grown_ns: int = 0


class Sidestep:
    """Attributes:
    side: to which side the wish is turned now; empty: to none.
    """

    def __init__(self) -> None:
        self._progress, self._stuck = Progress(), Progress()
        self._step: _Step | None = None

    @property
    def side(self) -> str:
        """See the class."""
        return self._step.side if self._step is not None else ""

    def turn(self, wanted: Vector3, instant: Instant) -> Vector3:
        """The wish for this tick: the wanted velocity (m/s), or that one turned to the side."""
        if norm(wanted) < NOTHING:
            self._step = None
            return wanted
        if self._step is not None and self._over(self._step, wanted, instant):
            self._step = None
            self._progress.reset()
        if self._step is None:
            self._step = self._begin(wanted, instant)
        step = self._step
        if step is None:
            return wanted
        if instant.now_ns - step.since_ns > LONGEST_NS:
            step.side, step.since_ns = OTHER[step.side], instant.now_ns
            step.across = towards(step.wanted, step.side)
        turned = turned_towards(wanted, step.across, step.angle)
        stuck = self._stuck.lacking(turned, instant.velocity, instant.now_ns)
        stuck = stuck and instant.now_ns - step.grown_ns >= GROW_NS
        if stuck:
            step.grown_ns = instant.now_ns
        step.angle = self._adjusted(step, wanted, instant.free, stuck=stuck)
        return turned_towards(wanted, step.across, step.angle)

    def _begin(self, wanted: Vector3, instant: Instant) -> _Step | None:
        if not self._progress.lacking(wanted, instant.velocity, instant.now_ns) or instant.free([wanted])[0]:
            return None
        way = way_round(wanted, instant.free)
        if way is None:
            return None
        across = towards(wanted, way.side)
        self._stuck.reset()
        return _Step(instant.position, wanted, way.side, across, way.angle, instant.now_ns)

    @staticmethod
    def _over(step: _Step, wanted: Vector3, instant: Instant) -> bool:
        """Past its start, or the wish has turned round."""
        speed = norm(step.wanted)
        made = sum((x - s) * u for x, s, u in zip(instant.position, step.start, step.wanted, strict=True))
        return made > PAST * speed or sum(u * v for u, v in zip(wanted, step.wanted, strict=True)) < 0.0

    @staticmethod
    def _adjusted(step: _Step, wanted: Vector3, free: Free, *, stuck: bool) -> float:
        """The angle: down while it is free, else up until it is; up, too, where the robot stands all the same."""
        count = round(step.angle / STEP)
        verdicts = free(fan(wanted, step.across))
        if verdicts[count] and not stuck:
            while count > 0 and verdicts[count - 1]:
                count -= 1
            return ANGLES[count]
        return next((ANGLES[k] for k in range(count + 1, len(ANGLES)) if verdicts[k]), ANGLES[-1])
