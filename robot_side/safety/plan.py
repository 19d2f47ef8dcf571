"""What the robot plays between commands: the one rule that the operator's prediction relies on, too."""

from farhand.common.messages.base import ZERO, Vector3
from farhand.common.messages.command import VelocityCommand


class PlanPlayer:
    """A velocity and the plan behind it, played out against the robot's own clock.

    With j = floor(h / period), h the time since the command was applied: j = 0 is the velocity,
    1..len(plan) is plan[j - 1], and an exhausted plan is zero velocity.
    """

    def __init__(self) -> None:
        self._velocity: Vector3 = ZERO
        self._plan: tuple[Vector3, ...] = ()
        self._period_ns = 1
        self._applied_ns = 0

    def load(self, command: VelocityCommand, now_ns: int) -> None:
        """Play this command from now on."""
        self._velocity, self._plan = command.velocity, command.plan
        self._period_ns, self._applied_ns = command.plan_period_ns, now_ns

    def clear(self) -> None:
        """Play zero velocity from now on."""
        self._velocity, self._plan = ZERO, ()

    def velocity(self, now_ns: int) -> Vector3:
        """Tool velocity at `now_ns` (m/s, base)."""
        j = (now_ns - self._applied_ns) // self._period_ns
        if j <= 0:
            return self._velocity
        return self._plan[j - 1] if j <= len(self._plan) else ZERO
