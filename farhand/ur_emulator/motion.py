"""The controller's set point: where the joints shall be and how fast, cycle by cycle."""

import numpy as np

from farhand.common.geometry import Array
from farhand.robot_side.arm.chain import ArmChain
from farhand.robot_side.arm.model import ArmModel

REACHED = 1e-5
"""rad, and rad/s."""
BRAKE_OF_STOP = 20.0
"""rad/s^2: of the controller's own stops, and at the end of a program that left the arm moving."""


class Motion:
    """One motion at a time; each begins at the set point that the last one left.

    Speed scaling slows all of them. The leading joint keeps to the acceleration, the others go along in proportion.

    Args:
        arm: its kinematics and limits.
        q: (n,) where it stands (rad).

    Attributes:
        q, qd: (n,) the set point (rad, rad/s).
        asked: (n,) the speed that is asked for, before scaling and acceleration (rad/s).
    """

    def __init__(self, arm: ArmModel, q: Array) -> None:
        self._arm = arm
        self._chain = ArmChain(arm)
        self.q: Array = np.array(q, dtype=float)
        self.qd: Array = np.zeros(arm.n)
        self.asked: Array = np.zeros(arm.n)
        self._acceleration = BRAKE_OF_STOP
        self._goal: Array | None = None
        self._fastest = 0.0
        self._within = 0.0  # s, in which a servo goal shall be reached; 0: a goal with a ramp

    @property
    def stands(self) -> bool:
        """Whether nothing moves and nothing is asked for."""
        return self._goal is None and not self.asked.any() and not self.qd.any()

    @property
    def settled(self) -> bool:
        """Whether what was asked for last is reached."""
        if self._goal is not None:
            return bool(np.abs(self._goal - self.q).max() < REACHED)
        return bool(np.abs(self.asked - self.qd).max() < REACHED)

    def place(self, q: Array) -> None:
        """Stand at q."""
        self.q[:], self.qd[:] = q, 0.0
        self.stop(BRAKE_OF_STOP)

    def speed(self, qd: Array, acceleration: float) -> None:
        """Joint speeds (rad/s), kept until something else is asked for."""
        limit = self._arm.max_velocity
        self._goal = None
        self.asked, self._acceleration = np.clip(qd, -limit, limit), acceleration

    def speed_of_tool(self, xd: Array, acceleration: float) -> None:
        """Speed of the flange in the controller's base, (6,) m/s and rad/s; that base is turned by half a turn."""
        v = np.array(xd) * [-1.0, -1.0, 1.0, -1.0, -1.0, 1.0]
        J = self._chain.at(self.q, self.qd).jacobian
        qd = J.T @ np.linalg.solve(J @ J.T + 1e-6 * np.eye(6), v)
        length = float(np.linalg.norm(v[:3]))
        self.speed(qd, acceleration * float(np.abs(qd).max()) / length if length > 1e-6 else acceleration)

    def stop(self, acceleration: float) -> None:
        """Brake to a stand."""
        self._goal = None
        self.asked, self._acceleration = np.zeros(self._arm.n), acceleration

    def go(self, q: Array, acceleration: float, speed: float) -> None:
        """To joint positions (rad), the leading joint with a ramp."""
        self._goal, self._acceleration, self._fastest, self._within = np.array(q), acceleration, speed, 0.0

    def servo(self, q: Array, within: float) -> None:
        """After a goal that moves: be there `within` s."""
        self._goal, self._within = np.array(q), max(within, 1e-3)

    def step(self, dt: float, scaling: float) -> None:
        """One cycle of `dt` s at a speed scaling of 0 to 1."""
        acceleration = max(self._acceleration, 1e-3)
        if self._goal is None:
            wanted = self.asked * scaling
        else:
            wanted = self._towards(self._goal, dt) * scaling
            if self._within:
                acceleration = float(self._arm.max_acceleration.max())
        change = wanted - self.qd
        most = float(np.abs(change).max())
        if most > acceleration * dt:
            change = change * (acceleration * dt / most)
        self.qd = self.qd + change
        self.q = self.q + self.qd * dt

    def _towards(self, goal: Array, dt: float) -> Array:
        away = goal - self.q
        farthest = float(np.abs(away).max())
        if farthest < REACHED:
            return np.zeros(len(away))
        if self._within:
            limit = self._arm.max_velocity
            followed: Array = np.clip(away / self._within, -limit, limit)
            return followed
        braking = float(np.sqrt(2.0 * self._acceleration * 0.8 * farthest))
        speed = min(self._fastest, braking, farthest / dt)
        ramped: Array = away / farthest * speed
        return ramped
