"""Which joint velocities may be commanded next."""

import numpy as np

from farhand.common.geometry import Array
from farhand.robot_side.kernel.velocity import joint_box


class JointBounds:
    """A box of joint velocities from velocity limits, braking before position limits, and acceleration.

    Args:
        lower, upper: (n,) joint position limits (rad).
        max_velocity: (n,) rad/s.
        max_acceleration: (n,) rad/s^2, or one for all; also the deceleration that braking before a limit counts on.

    Attributes:
        limits: (4, n) all of them, as compiled code reads them.
    """

    def __init__(
        self, lower: Array, upper: Array, max_velocity: Array, max_acceleration: Array | float
    ) -> None:
        self.n = len(lower)
        acceleration = np.broadcast_to(np.asarray(max_acceleration, dtype=float), (self.n,))
        self.limits: Array = np.array([lower, upper, max_velocity, acceleration], dtype=float)

    def at(self, q: Array, previous: Array, dt: float) -> tuple[Array, Array]:
        """Lowest and highest next velocities (n,), rad/s; acceleration wins over the other two.

        Args:
            q: (n,) joint positions now (rad).
            previous: (n,) velocities commanded last (rad/s).
            dt: control period (s).
        """
        low, high = np.empty(self.n), np.empty(self.n)
        joint_box(self.limits, q, previous, dt, low, high)
        return low, high
