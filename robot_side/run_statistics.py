"""What the robot side measures about its own run: clearances, path, trajectory."""

import math

from farhand.common.messages.base import Vector3
from farhand.robot_side.scene.obstacle_field import NOTHING_NEAR

TRAJECTORY_RATE_HZ = 50.0
TRAJECTORY_LIMIT = 1_000_000


class RunStatistics:
    """Fed once a tick with the true state.

    Args:
        rate_hz: of the ticks.

    Attributes:
        min_clearance: the smallest clearance of the tool's sphere (m).
        min_arm_clearance: the smallest clearance of the whole arm (m); None where not computed.
        path_length: way of the tool (m).
        start_ns: first tick; None before.
        nearest: position (m) and instant of the smallest clearance; None before.
        longest_silence: (s).
        trajectory: (t, x, y, z, clearance), t in s since the first tick, thinned to 50 Hz.
    """

    def __init__(self, rate_hz: float) -> None:
        self._every = max(1, round(rate_hz / TRAJECTORY_RATE_HZ))
        self.start_ns: int | None = None
        self.nearest: tuple[Vector3, int] | None = None
        self.longest_silence = 0.0
        self._last: Vector3 | None = None
        self._samples = 0
        self.min_clearance = NOTHING_NEAR
        self.min_arm_clearance: float | None = None
        self.path_length = 0.0
        self.trajectory: list[tuple[float, float, float, float, float]] = []

    def add(self, now_ns: int, position: Vector3, clearance: float) -> None:
        """Note one tick: tool position (m), its clearance (m)."""
        if clearance < self.min_clearance:
            self.min_clearance, self.nearest = clearance, (position, now_ns)
        if self._last is not None:
            self.path_length += math.dist(position, self._last)
        self._last = position
        if self.start_ns is None:
            self.start_ns = now_ns
        if self._samples % self._every == 0 and len(self.trajectory) < TRAJECTORY_LIMIT:
            self.trajectory.append(((now_ns - self.start_ns) * 1e-9, *position, clearance))
        self._samples += 1

    def add_arm(self, clearance: float | None) -> bool:
        """Note the clearance of the whole arm (m); whether it is the smallest so far."""
        if clearance is None or (self.min_arm_clearance is not None and clearance >= self.min_arm_clearance):
            return False
        self.min_arm_clearance = clearance
        return True

    def add_silence(self, silence_ns: int) -> None:
        """Note how long the one in control has not been heard."""
        silence = silence_ns * 1e-9
        if silence > self.longest_silence:
            self.longest_silence = silence
