"""A robot that makes no progress: since when, and what holds it."""

import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from operator import attrgetter

from farhand.common.messages.base import Vector3
from farhand.common.messages.command import CommandMode
from farhand.common.messages.state import RobotState

WINDOW_NS = 3_000_000_000
PROGRESS = 0.1
"""Of the way that was wanted: who comes less far makes none."""
LEAST_WAY = 0.01
"""A wish for less than this (m in 3 s) is none."""
OLD_NS = 1_000_000_000


@dataclass(frozen=True, slots=True)
class Attempt:
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


_DESIRED, _SENT = attrgetter("desired"), attrgetter("sent")


def side_words(side: str) -> str:
    """`to the left`, `above`: a side of who looks along the way that is wanted."""
    return f"to the {side}" if side in ("left", "right") else side


class Standstill:
    """Compares, over the last 3 s, the way that was wanted and the one that was made.

    What holds the robot on purpose (a stop, a device that is not engaged) has its reason in the report already;
    so has a silence. Of the rest the robot itself knows its limits, and the filter its obstacles.
    """

    def __init__(self) -> None:
        self._past: deque[tuple[Attempt, Vector3]] = deque()
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
        past.append((attempt, state.position))
        while len(past) > 1 and attempt.now_ns - past[1][0].now_ns >= WINDOW_NS:
            past.popleft()
        if attempt.now_ns - past[0][0].now_ns < WINDOW_NS:
            return ""
        wanted = self._way(_DESIRED)
        enough = PROGRESS * wanted
        if wanted < LEAST_WAY or math.dist(past[0][1], state.position) >= enough or self._along() >= enough:
            self._bound = attempt.binding
            return ""
        return self._holder(state, follows=self._way(_SENT) <= 2 * enough)

    def _way(self, velocity: Callable[[Attempt], Vector3]) -> float:
        """Length of the way that a velocity makes over the window (m)."""
        x = y = z = 0.0
        for (attempt, _), (after, _) in pairwise(self._past):
            dt = (after.now_ns - attempt.now_ns) * 1e-9
            u, v, w = velocity(attempt)
            x, y, z = x + u * dt, y + v * dt, z + w * dt
        return math.hypot(x, y, z)

    def _along(self) -> float:
        """The way made along what was wanted at each tick (m): a robot that turned back at a target made some."""
        total = 0.0
        for (attempt, start), (_, end) in pairwise(self._past):
            wish = math.hypot(*attempt.desired)
            if wish > 0.0:
                total += sum(d * (e - s) for d, s, e in zip(attempt.desired, start, end, strict=True)) / wish
        return total

    def _holder(self, state: RobotState, *, follows: bool) -> str:
        """Who holds it: the robot's own limits, an obstacle, another reason of the filter."""
        if state.held_by:
            return f"the robot: {state.held_by}"
        guarded = self._past[-1][0].guarded
        if guarded and not follows:
            return f"the robot's guard, which keeps {guarded}"
        if self._bound:
            side = self._past[-1][0].free_side
            return f"obstacle {self._bound!r}" + (
                f"; the way round is free {side_words(side)}" if side else ""
            )
        reason = next((a.reason for a, _ in reversed(self._past) if a.reason), "")
        if reason:
            return reason
        return (
            "the filter, without an obstacle" if follows else "the robot, which does not follow its commands"
        )
