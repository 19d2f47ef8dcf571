"""Which joint velocities may be commanded next."""

import numpy as np

from farhand.common.geometry import Array


class JointBounds:
    """A box of joint velocities from velocity limits, braking before position limits, and acceleration.

    Args:
        lower, upper: (n,) joint position limits (rad).
        max_velocity: (n,) rad/s.
        max_acceleration: (n,) rad/s^2, or one for all; also the deceleration that braking before a limit counts on.
    """

    def __init__(
        self, lower: Array, upper: Array, max_velocity: Array, max_acceleration: Array | float
    ) -> None:
        self.n = len(lower)
        self._lower, self._upper = lower, upper
        self._max_velocity = max_velocity
        self._acceleration = max_acceleration

    def at(self, q: Array, previous: Array, dt: float) -> tuple[Array, Array]:
        """Lowest and highest next velocities (n,), rad/s.

        Args:
            q: (n,) joint positions now (rad).
            previous: (n,) velocities commanded last (rad/s).
            dt: control period (s).
        """
        a = self._acceleration
        # v dt + v^2 / (2a) <= way left, solved for v
        highest = np.sqrt((a * dt) ** 2 + 2 * a * np.maximum(self._upper - q, 0.0)) - a * dt
        lowest = a * dt - np.sqrt((a * dt) ** 2 + 2 * a * np.maximum(q - self._lower, 0.0))
        high = np.minimum(highest, self._max_velocity)
        low = np.maximum(lowest, -self._max_velocity)
        # Acceleration wins: the box is never empty, and no limit asks for more than the arm can do.
        least, most = previous - a * dt, previous + a * dt
        return np.minimum(np.maximum(low, least), most), np.minimum(np.maximum(high, least), most)
