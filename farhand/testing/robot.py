"""A robot whose motion and failures a test decides."""

from collections import Counter
from collections.abc import Sequence
from typing import Any, Literal

from msgspec.structs import replace

from farhand.common.geometry import Twist, turned
from farhand.common.messages.base import Vector3
from farhand.common.messages.scene import Obstacle
from farhand.robot_side.robots.robot import Robot, RobotSample
from farhand.robot_side.robots.settings import RobotScenario
from farhand.robot_side.scene.surroundings import Surroundings

Call = Literal["sample", "step", "arm_clearance"]
FOR_EVER = 1 << 62


class ScriptedRobot(Robot):
    """Follows every commanded twist at once, unless the test says where it is or what breaks.

    Args:
        position: of the tool at the start (m).
        clearance: what `arm_clearance` answers (m); None: not computed.

    Attributes:
        told: every (velocity in m/s, dt in s) that `step` was given and did not fail in.
        turned: the angular velocities (rad/s) that it was given with them.
        surroundings: what it was given last to keep clear of; None: no guard.
        stuck: while it holds, commands move nothing.
        closed: how often `close` was called.
    """

    def __init__(self, position: Vector3 = (0.0, 0.0, 0.0), clearance: float | None = None) -> None:
        self.told: list[tuple[Vector3, float]] = []
        self.turned: list[Vector3] = []
        self.surroundings: Surroundings | None = None
        self.stuck = False
        self.closed = 0
        self.clearance = clearance
        self._sample = RobotSample(position, (0.0, 0.0, 0.0))
        self._failures: Counter[str] = Counter()
        self._error: Exception = RuntimeError("gearbox")

    @classmethod
    def for_scenario(cls, scenario: RobotScenario) -> "ScriptedRobot":
        """At the scenario's start."""
        return cls(scenario.start)

    def show(self, **fields: Any) -> None:
        """From now on the sample has these fields, such as `position`, `velocity`, `joints`."""
        self._sample = replace(self._sample, **fields)

    def fail(self, call: Call, times: int = FOR_EVER, error: Exception | None = None) -> None:
        """Raise in the next so many calls of that method; a RuntimeError unless another one is given."""
        self._failures[call] = times
        self._error = error or self._error

    def sample(self) -> RobotSample:
        """Where it is."""
        self._fail("sample")
        return self._sample

    def step(self, twist: Twist, dt: float, surroundings: Surroundings | None = None) -> None:
        """Move for `dt` s with the twist, unless it is stuck."""
        self._fail("step")
        velocity, angular = twist
        self.told.append((velocity, dt))
        self.turned.append(angular)
        self.surroundings = surroundings
        if not self.stuck:
            x, y, z = (p + v * dt for p, v in zip(self._sample.position, velocity, strict=True))
            a, b, c = (rate * dt for rate in angular)
            self._sample = replace(
                self._sample,
                position=(x, y, z),
                velocity=velocity,
                orientation=turned(self._sample.orientation, (a, b, c)),
                angular_velocity=angular,
            )

    def arm_clearance(self, obstacles: Sequence[Obstacle]) -> float | None:
        """What the test says."""
        self._fail("arm_clearance")
        return self.clearance

    def close(self) -> None:
        """Counted in `closed`."""
        self.closed += 1

    def _fail(self, call: Call) -> None:
        if self._failures[call] > 0:
            self._failures[call] -= 1
            raise self._error
