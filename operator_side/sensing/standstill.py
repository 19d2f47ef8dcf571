"""A robot that makes no progress: since when, and what holds it."""

import math
from collections import deque

import msgspec

from farhand.common.geometry import norm
from farhand.common.messages.base import ZERO, Vector3
from farhand.common.messages.command import CommandMode
from farhand.common.messages.state import RobotState
from farhand.operator_side.prediction.law import moved

WINDOW_NS = 3_000_000_000
PROGRESS = 0.1
"""Of the way that was wanted: who comes less far makes none."""
LEAST_WAY = 0.01
"""A wish for less than this (m in 3 s) is none."""
OLD_NS = 1_000_000_000


class Attempt(msgspec.Struct, frozen=True):
    """One tick.

    Attributes:
        now_ns: its beginning.
        mode, reason: of the command; why it is zero, or empty.
        desired, sent: velocity before and after the filter (m/s).
        binding: id of the obstacle that binds, or empty.
        free_side: on which side the way round it is free; empty: on none, or nobody knows.
        guarded: what the guard on the robot keeps off what; empty: it does nothing.
    """

    now_ns: int
    mode: CommandMode
    reason: str
    desired: Vector3
    sent: Vector3
    binding: str
    free_side: str = ""
    guarded: str = ""


class _Past(msgspec.Struct, frozen=True):
    """A tick, where the robot was, and what had come together before it since the first one.

    Attributes:
        position: (m).
        desired, sent: ways that these velocities made (m).
        along: the way made along what was wanted at each tick (m): a robot that turned back at a target made some.
    """

    attempt: Attempt
    position: Vector3
    desired: Vector3 = ZERO
    sent: Vector3 = ZERO
    along: float = 0.0

    def then(self, attempt: Attempt, position: Vector3) -> "_Past":
        """The next tick, after this one's velocities have gone on until then."""
        mine, dt = self.attempt, (attempt.now_ns - self.attempt.now_ns) * 1e-9
        wish = norm(mine.desired)
        made = sum(d * (e - s) for d, s, e in zip(mine.desired, self.position, position, strict=True))
        along = self.along + (made / wish if wish > 0.0 else 0.0)
        desired, sent = moved(self.desired, mine.desired, dt), moved(self.sent, mine.sent, dt)
        return _Past(attempt, position, desired, sent, along)


def side_words(side: str) -> str:
    """`to the left`, `above`: a side of who looks along the way that is wanted."""
    return f"to the {side}" if side in ("left", "right") else side


class Standstill:
    """Compares, over the last 3 s, the way that was wanted and the one that was made.

    What holds the robot on purpose (a stop, a device that is not engaged) has its reason in the report already;
    so has a silence. Of the rest the robot itself knows its limits, and the filter its obstacles.
    """

    def __init__(self) -> None:
        self._past: deque[_Past] = deque()
        self._bound = ""  # the obstacle that bound last while there was no progress

    def step(self, attempt: Attempt, state: RobotState | None, state_age_ns: int) -> str:
        """What holds the robot; empty while it makes progress, or nobody wants any.

        Args:
            attempt: this tick.
            state: newest of the robot.
            state_age_ns: since it came.
        """
        if state is None or attempt.mode != "run" or state_age_ns > OLD_NS:
            self._past.clear()
            self._bound = ""
            return ""
        self._bound = attempt.binding or self._bound
        past = self._past
        now = past[-1].then(attempt, state.position) if past else _Past(attempt, state.position)
        past.append(now)
        while len(past) > 1 and attempt.now_ns - past[1].attempt.now_ns >= WINDOW_NS:
            past.popleft()
        first = past[0]
        if attempt.now_ns - first.attempt.now_ns < WINDOW_NS:
            return ""
        wanted, sent = math.dist(first.desired, now.desired), math.dist(first.sent, now.sent)
        made = max(math.dist(first.position, state.position), now.along - first.along)
        if wanted < LEAST_WAY or made >= PROGRESS * wanted:
            self._bound = attempt.binding
            return ""
        return self._holder(state, follows=sent <= 2 * PROGRESS * wanted)

    def _holder(self, state: RobotState, *, follows: bool) -> str:
        """Who holds it: the robot's own limits, an obstacle, another reason of the filter."""
        if state.held_by:
            return f"the robot: {state.held_by}"
        guarded = self._past[-1].attempt.guarded
        if guarded and not follows:
            return f"the robot's guard, which keeps {guarded}"
        if self._bound:
            side = self._past[-1].attempt.free_side
            return f"obstacle {self._bound!r}" + (
                f"; the way round is free {side_words(side)}" if side else ""
            )
        reason = next((past.attempt.reason for past in reversed(self._past) if past.attempt.reason), "")
        if reason:
            return reason
        return (
            "the filter, without an obstacle" if follows else "the robot, which does not follow its commands"
        )
