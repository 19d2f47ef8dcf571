"""What a robot with lag needs of every margin law: larger radii for z, and a pace at which they leave a way."""

import numpy as np

from farhand.common.geometry import Array, norm
from farhand.common.messages.base import Vector3
from farhand.operator_side.margins.lag import radii_for_lag, trails_that_fit

SLOWEST = 0.1
"""Share of the speed that is always left."""
STEP = 1.1
"""By how much the pace changes in TICK."""
TICK = 0.1
"""s."""
BLOCKED = 0.3
"""Share of the wanted speed below which the way counts as blocked."""
WORTH_SLOWING = 0.01
"""A lag part from which slowing down is worth it (m); below, it opens no way."""


class Trail:
    """The lag part depends on the speed, so that a margin of what is merely wanted may close a passage, or grow
    over a robot that stands. Then the wish is slowed down: at once as far as the lag part leaves z where it is,
    and step by step while the robot is held up; step by step it is let go again.

    Args:
        speed_limit: u_b for each axis (m/s).
        lag: of the robot (s), above 0.
        tick: from one command to the next (s).
    """

    def __init__(self, speed_limit: Vector3, lag: float, tick: float = TICK) -> None:
        self._change = STEP ** (tick / TICK)
        self._lag = lag
        self._fastest = norm(speed_limit)
        self._slowest = SLOWEST * min(speed_limit)
        self._pace = 1.0

    def desired(self, wanted: Array, radii: Array, gaps: Array, speeds: Array) -> Array:
        """The velocity that is wanted, slowed down where need be (m/s).

        Args:
            wanted: (3,) m/s.
            radii: (n,) that the body must keep (m).
            gaps: (n,) from the obstacles' centres to z (m).
            speeds: (n,) of the obstacles (m/s).
        """
        speed = norm(wanted.tolist())
        room = np.minimum.reduce(gaps - radii - self._lag * speeds, initial=np.inf)
        if (
            self._pace == 1.0 and room >= self._lag * speed
        ):  # a trail as long as gap - radius fits in any case
            return wanted
        fitting_gaps = np.maximum(gaps, radii + WORTH_SLOWING)
        fitting = float(np.min(trails_that_fit(radii, fitting_gaps) / self._lag - speeds, initial=np.inf))
        most = max(self._slowest, min(fitting, self._pace * speed))
        return wanted * (most / speed) if speed > most else wanted

    def radii(self, radii: Array, desired: Array, speed: float, speeds: Array) -> Array:
        """(n,) what z must keep, so that the body keeps `radii` (m).

        The curve is driven at the speed that is wanted, or at the robot's own (`speed`), as far as the limits
        allow; round a moving obstacle the obstacle's speed comes on top.
        """
        fastest = min(self._fastest, max(norm(desired.tolist()), speed))
        return radii_for_lag(radii, self._lag * (fastest + speeds))

    def learn(self, desired: Array, velocity: Array, part: float) -> None:
        """Look at what became of a tick: the desired and the commanded velocity (m/s), the lag part (m)."""
        held_up = part > WORTH_SLOWING and norm(velocity.tolist()) < BLOCKED * norm(desired.tolist())
        self._pace = (
            max(SLOWEST, self._pace / self._change) if held_up else min(1.0, self._pace * self._change)
        )
