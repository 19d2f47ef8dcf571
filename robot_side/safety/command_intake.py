"""From packets to judged commands: the edge where malformed bytes and floods end."""

from collections import Counter
from collections.abc import Sequence

from farhand.common.link.link import Packet
from farhand.common.messages.codec import Decoder
from farhand.common.messages.command import VelocityCommand
from farhand.common.messages.echo import Newest
from farhand.common.messages.keys import command_key
from farhand.robot_side.safety.watchdog import Watchdog

DECODES_PER_TICK = 256


class CommandIntake:
    """Decodes what arrives under the robot's command key and hands it to the watchdog.

    Args:
        name: the robot's name, part of the key.
        watchdog: judges the commands.

    Attributes:
        newest: the newest command of the session in control, for the echo.
        arrived: messages under the key, whatever became of them.
        received: those of them that could be decoded.
    """

    def __init__(self, name: str, watchdog: Watchdog) -> None:
        self._key = command_key(name)
        self._watchdog = watchdog
        self._decoder = Decoder(VelocityCommand)
        self._flood: Counter[str] = Counter()
        self.newest = Newest()
        self.arrived = 0
        self.received = 0

    def take(self, packets: Sequence[Packet], now_ns: int) -> None:
        """Judge what has arrived, in order; of a flood only the newest are looked at, the rest counted."""
        if not packets:
            return
        commands = [packet for packet in packets if packet.key == self._key]
        self.arrived += len(commands)
        excess = len(commands) - DECODES_PER_TICK
        if excess > 0:
            self._flood["flood"] += excess
            commands = commands[excess:]
        for packet in commands:
            command = self._decoder.decode(packet.payload)
            if command is None:
                continue
            self.received += 1
            self._watchdog.receive(command, now_ns)
            if self._watchdog.in_control(command):
                self.newest.accept(command, min(packet.arrived_ns or now_ns, now_ns))

    def refused(self) -> dict[str, int]:
        """Commands refused so far, by reason, those of the watchdog among them."""
        total: dict[str, int] = {}  # asked for with every state: adding Counters takes ten times as long
        for counts in (self._decoder.refused, self._watchdog.refused, self._flood):
            for reason, count in counts.items():
                total[reason] = total.get(reason, 0) + count
        return total
