"""A point that follows the commanded twist with a first-order lag: the cheapest honest robot."""

import math

from farhand.common.geometry import Twist, turned
from farhand.common.messages.base import ZERO, Quaternion, Vector3
from farhand.robot_side.robots.robot import Robot, RobotSample
from farhand.robot_side.robots.settings import RobotScenario
from farhand.robot_side.scene.surroundings import Surroundings


class PointRobot(Robot):
    """lag * dv/dt = u - v, dx/dt = v, integrated exactly over each period; its attitude turns by the same law.

    Args:
        start: position (m).
        lag: time constant (s); 0 follows at once.
    """

    catches_up = True

    def __init__(self, start: Vector3, lag: float) -> None:
        self._position = start
        self._velocity: Vector3 = ZERO
        self._orientation: Quaternion = (1.0, 0.0, 0.0, 0.0)
        self._angular: Vector3 = ZERO
        self._lag = lag
        self._dt = -1.0
        self._decay = 0.0

    @classmethod
    def for_scenario(cls, scenario: RobotScenario) -> "PointRobot":
        """See Robot."""
        return cls(scenario.start, scenario.robot.lag)

    def sample(self) -> RobotSample:
        """The state now."""
        return RobotSample(self._position, self._velocity, self._orientation, angular_velocity=self._angular)

    def step(self, twist: Twist, dt: float, surroundings: Surroundings | None = None) -> None:
        """One period of `dt` s under the commanded twist."""
        velocity = twist.linear
        if dt != self._dt:
            self._dt = dt
            self._decay = math.exp(-dt / self._lag) if self._lag > 0.0 else 0.0
        decay = self._decay
        reach = self._lag * (1.0 - decay)
        (x, y, z), (vx, vy, vz), (ux, uy, uz) = self._position, self._velocity, velocity
        ex, ey, ez = vx - ux, vy - uy, vz - uz
        self._position = (x + ux * dt + ex * reach, y + uy * dt + ey * reach, z + uz * dt + ez * reach)
        self._velocity = (ux + ex * decay, uy + ey * decay, uz + ez * decay)
        if twist.angular != ZERO or self._angular != ZERO:
            self._turn(twist.angular, dt)

    def _turn(self, angular: Vector3, dt: float) -> None:
        (vx, vy, vz), (ux, uy, uz) = self._angular, angular
        ex, ey, ez = vx - ux, vy - uy, vz - uz
        reach, decay = self._lag * (1.0 - self._decay), self._decay
        turn = (ux * dt + ex * reach, uy * dt + ey * reach, uz * dt + ez * reach)
        self._orientation = turned(self._orientation, turn)
        self._angular = (ux + ex * decay, uy + ey * decay, uz + ez * decay)
