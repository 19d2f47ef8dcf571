"""What the robot plays between commands: the one rule that the operator's prediction relies on, too."""

from farhand.common.geometry import STILL, Twist
from farhand.common.messages.base import ZERO
from farhand.common.messages.command import VelocityCommand


class PlanPlayer:
    """A twist and the plan behind it, played out against the robot's own clock.

    With j = floor(h / period), h the time since the command was applied: j = 0 is (velocity, angular),
    1..len(plan) is (plan[j - 1], plan_angular[j - 1]), and an exhausted plan is zero. The turning ends with the
    plan: a `plan_angular` that is longer is not played out, of one that is shorter the rest is zero.
    """

    def __init__(self) -> None:
        self._command: VelocityCommand | None = None
        self._entry, self._twist = -1, STILL  # the one that is played
        self._period_ns = 1
        self._applied_ns = 0

    def load(self, command: VelocityCommand, now_ns: int) -> None:
        """Play this command from now on."""
        self._command, self._entry = command, -1
        self._period_ns, self._applied_ns = command.plan_period_ns, now_ns

    def clear(self) -> None:
        """Play zero from now on."""
        self._command, self._entry, self._twist = None, -1, STILL

    def twist(self, now_ns: int) -> Twist:
        """Twist of the tool at `now_ns` (base)."""
        if self._command is None:
            return STILL
        j = max(0, (now_ns - self._applied_ns) // self._period_ns)
        if j != self._entry:
            self._entry, self._twist = j, _entry(self._command, j)
        return self._twist


def _entry(command: VelocityCommand, j: int) -> Twist:
    if j == 0:
        return Twist(command.velocity, command.angular)
    if j > len(command.plan):
        return STILL
    turning = command.plan_angular
    return Twist(command.plan[j - 1], turning[j - 1] if j <= len(turning) else ZERO)
