"""What may move the robot, by rules of its own: nothing here asks the robot's program what it decided.

The judge sees every packet that reaches the robot and every command that the lawful operator really sent. A packet
counts if it is, byte for byte, one of those, newer than all that came before, and built on a state of this robot that
is at most `max_age` old. What is explained is the plan of such a packet from its arrival on, entry by entry, and
zero. It need not be that of the newest one: the robot may have refused that, and plays out the plan before it.
"""

from collections import deque
from collections.abc import Iterable

from farhand.common.geometry import STILL, Twist, distance
from farhand.common.link.link import Packet
from farhand.common.messages.base import ZERO
from farhand.common.messages.command import VelocityCommand

REMEMBERED = 40
"""Fresh commands: 4 s of them, longer than any plan lasts."""
LIKE = 1e-9
"""m/s, rad/s: what is nearer to each other is the same twist."""


class Judge:
    """Args:
    session: of the robot, which what moves it must be built on.
    key: of its commands.
    max_age_ns: of the state that a command is built on.

    Attributes:
        lawful: every command that the lawful operator sent, by its bytes.
        unexplained: periods in which the robot was told a motion that nothing lawful and fresh explains.
        fastest: of them (m/s).
        oldest_ns: age of the oldest state that a command was built on which moved it.
    """

    def __init__(self, session: int, key: str, max_age_ns: int) -> None:
        self._session, self._key, self._max_age_ns = session, key, max_age_ns
        self._newest = -1
        self._fresh: deque[tuple[VelocityCommand, int, int]] = deque(maxlen=REMEMBERED)
        self.lawful: dict[bytes, VelocityCommand] = {}
        self.unexplained = 0
        self.fastest = 0.0
        self.oldest_ns = 0

    def sent(self, payload: bytes, command: VelocityCommand) -> None:
        """The lawful operator sent this."""
        self.lawful[payload] = command

    def taken(self, packets: Iterable[Packet], now_ns: int) -> None:
        """The robot takes these, in this order."""
        for packet in packets:
            command = self.lawful.get(packet.payload) if packet.key == self._key else None
            if command is None or command.seq <= self._newest:
                continue
            self._newest = command.seq
            echo = command.echo
            if command.mode != "run" or echo is None or echo.session != self._session:
                continue
            age_ns = now_ns - echo.t_sent_ns
            if 0 <= age_ns <= self._max_age_ns:
                self._fresh.appendleft((command, now_ns, age_ns))

    def told(self, twist: Twist, now_ns: int) -> None:
        """The robot is told this twist for the period from now on."""
        if twist == STILL:
            return
        for command, since_ns, age_ns in self._fresh:
            if _alike(twist, _entry(command, (now_ns - since_ns) // command.plan_period_ns)):
                self.oldest_ns = max(self.oldest_ns, age_ns)
                return
        self.unexplained += 1
        self.fastest = max(self.fastest, max(map(abs, twist.linear)))


def _entry(command: VelocityCommand, number: int) -> Twist:
    if number == 0:
        return Twist(command.velocity, command.angular)
    if number > len(command.plan):
        return STILL
    turning = command.plan_angular
    return Twist(command.plan[number - 1], turning[number - 1] if number <= len(turning) else ZERO)


def _alike(a: Twist, b: Twist) -> bool:
    return distance(a.linear, b.linear) < LIKE and distance(a.angular, b.angular) < LIKE
