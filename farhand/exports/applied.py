"""What the robot really followed: which of the commands, and which of its velocities, by what its states say."""

from collections import OrderedDict

from farhand.common.messages.base import ZERO, Vector3
from farhand.common.messages.command import VelocityCommand
from farhand.common.messages.state import RobotState

KEPT = 1024
"""Commands back; older ones are applied by nobody."""
Twist = tuple[Vector3, Vector3]
"""Velocity (m/s) and angular velocity (rad/s)."""


class Applied:
    """Follows a run.

    Args:
        session: of the operator's program, whose commands these are.
    """

    def __init__(self, session: int) -> None:
        self._session = session
        self._sent: OrderedDict[int, VelocityCommand] = OrderedDict()

    def sent(self, command: VelocityCommand) -> None:
        """A command that left."""
        self._sent[command.seq] = command
        if len(self._sent) > KEPT:
            self._sent.popitem(last=False)

    def at(self, state: RobotState) -> Twist | None:
        """What the robot followed when it was sampled, zero where its watchdog holds it; None: nobody knows."""
        if state.mode != "run" or not state.applied_session:
            return ZERO, ZERO
        command = self._sent.get(state.applied_seq) if state.applied_session == self._session else None
        if command is None:
            return None
        period = state.applied_for_ns // command.plan_period_ns
        if period == 0:
            return command.velocity, command.angular
        return _entry(command.plan, period - 1), _entry(command.plan_angular, period - 1)


def _entry(plan: tuple[Vector3, ...], index: int) -> Vector3:
    return plan[index] if index < len(plan) else ZERO
