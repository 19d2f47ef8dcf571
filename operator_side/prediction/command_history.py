"""What was sent: the operator's memory of its own commands, and what the robot does with each of them.

The robot applies a command's velocity for one period of its plan, then plays out the plan one period an entry, then
stands. All vectors are plain tuples in the base frame (m, m/s): this runs for every tick of thousands of
simulated tasks.
"""

from collections import OrderedDict

import msgspec

from farhand.common.messages.base import ZERO, Vector3

KEPT = 256
"""Commands, where nothing else is said."""


class SentCommand(msgspec.Struct, frozen=True):
    """One command as the robot will play it.

    Attributes:
        seq: its sequence number.
        t_sent_ns: beginning of its tick.
        period: of the plan (s).
        velocities: the velocity and the plan after it (m/s).
        travelled: displacement after 0, 1, 2, ... whole periods (m).
        predicted: start state that the controller assumed (m).
        angular: the angular velocity and the plan after it (rad/s); what it does not say is zero.
    """

    seq: int
    t_sent_ns: int
    period: float
    velocities: tuple[Vector3, ...]
    travelled: tuple[Vector3, ...]
    predicted: Vector3
    angular: tuple[Vector3, ...] = ()

    def velocity(self, entry: int) -> Vector3:
        """Velocity in the given period since it took effect; zero when the plan is exhausted."""
        return self.velocities[entry] if entry < len(self.velocities) else ZERO

    def turning(self, entry: int) -> Vector3:
        """Angular velocity in the given period since it took effect; it ends with the plan."""
        return self.angular[entry] if entry < min(len(self.angular), len(self.velocities)) else ZERO

    def displacement(self, duration: float) -> Vector3:
        """How far the robot has gone `duration` s after the command took effect (m)."""
        whole = int(duration / self.period)
        if whole >= len(self.velocities):
            return self.travelled[-1]
        rest = duration - whole * self.period
        x, y, z = self.travelled[whole]
        u, v, w = self.velocities[whole]
        return (x + u * rest, y + v * rest, z + w * rest)


class CommandHistory:
    """The last commands of this session, by sequence number.

    Args:
        kept: how many.
    """

    def __init__(self, kept: int = KEPT) -> None:
        self._kept = kept
        self._commands: OrderedDict[int, SentCommand] = OrderedDict()

    def add(
        self,
        seq: int,
        t_sent_ns: int,
        period: float,
        velocities: tuple[Vector3, ...],
        predicted: Vector3,
        angular: tuple[Vector3, ...] = (),
    ) -> None:
        """Note a command that leaves; see SentCommand."""
        x = y = z = 0.0
        travelled = [ZERO]
        for u, v, w in velocities:
            x, y, z = x + u * period, y + v * period, z + w * period
            travelled.append((x, y, z))
        self._commands[seq] = SentCommand(
            seq, t_sent_ns, period, velocities, tuple(travelled), predicted, angular
        )
        if len(self._commands) > self._kept:
            self._commands.popitem(last=False)

    def get(self, seq: int) -> SentCommand | None:
        """The command with this sequence number, if it was sent and is still remembered."""
        return self._commands.get(seq)

    def newest_first(self) -> list[SentCommand]:
        """All remembered commands, newest first."""
        return list(reversed(self._commands.values()))
