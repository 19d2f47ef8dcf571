"""Whether something that moves comes to where the robot is: who would be run over must not be made to stand yet."""

from collections import deque

from farhand.common.geometry import norm
from farhand.robot_side.robots.robot import Robot, RobotSample
from farhand.robot_side.scene.obstacle_field import ObstacleField

AHEAD = 2.5
"""s: so far ahead it is looked. Who is made to stand has stood about as long before anything that is known meets it."""
STEP, MORE = 0.1, 0.05
"""s, m: between two instants that are looked at; what is kept beyond d_min, for movers between them, up to 1 m/s."""
LOOKS = round(AHEAD / STEP)
NOT_NEARER = 1e-6  # m
TOGETHER_NS = 250_000_000
"""Looks that are farther apart do not belong together."""
AT_REST = 0.01
"""m/s; what is faster is on its way aside."""


class Approach:
    """Looks ahead, along the ways that movers are known to take: at one instant at a time, to be quick.

    Args:
        robot: who might be met: all its links, or its sphere where it has none.
        radius: of the sphere (m).
        d_min: distance to be kept (m).
        period_ns: between two ticks.
    """

    def __init__(self, robot: Robot, radius: float, d_min: float, period_ns: int) -> None:
        self._robot, self._radius, self._kept = robot, radius, d_min + MORE
        self._together_ns = max(TOGETHER_NS, 2 * period_ns)
        self._field: ObstacleField | None = None
        self._looked_ns = 0
        self._met: deque[bool] = deque(maxlen=LOOKS)
        self._next = 0
        self._distance = 0.0  # at the instant of the first of these looks

    def comes(self, field: ObstacleField, sample: RobotSample, now_ns: int) -> bool:
        """Whether the robot is not at rest yet, or something comes too near if it stays, as far as was looked.

        To be called at every tick: after LOOKS of them it has looked at all of the time ahead. What was seen before a
        pause, or of other obstacles, says nothing.
        """
        if field is not self._field or not 0 <= now_ns - self._looked_ns <= self._together_ns:
            self._field, self._next = field, 0
            self._met.clear()
        self._looked_ns = now_ns
        if self._next == 0:
            self._distance = self._measured(field, sample, now_ns)
        self._next += 1
        then = self._measured(field, sample, now_ns + round(self._next * STEP * 1e9))
        # what stands beside it, or goes away, does not come
        self._met.append(then < min(self._kept, self._distance - NOT_NEARER))
        self._next %= LOOKS
        return norm(sample.velocity) > AT_REST or len(self._met) < LOOKS or any(self._met)

    def _measured(self, field: ObstacleField, sample: RobotSample, at_ns: int) -> float:
        """Least distance at an instant, if the robot stays (m)."""
        distance = self._robot.arm_clearance(field.at(at_ns))
        return field.clearance(sample.position, self._radius, at_ns) if distance is None else distance
