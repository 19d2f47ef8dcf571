"""What a console knows of its robot: the newest of everything, as it came on the report endpoint, and how old it is."""

from itertools import accumulate

from farhand.common.link.link import Packet
from farhand.common.messages.base import Message, Vector3
from farhand.common.messages.codec import Decoder
from farhand.common.messages.command import VelocityCommand
from farhand.common.messages.description import RobotDescription
from farhand.common.messages.echo import Newest
from farhand.common.messages.keys import mirror_key, report_key
from farhand.common.messages.report import ControlReport
from farhand.common.messages.scene import Scene
from farhand.common.messages.state import RobotState

NEVER = 1e9
"""The age of what never came (s)."""


class _Slot:
    """The newest message of one key."""

    def __init__(self, kind: type[Message]) -> None:
        self._decoder: Decoder[Message] = Decoder(kind)
        self.newest = Newest()
        self.message: Message | None = None

    def take(self, packet: Packet) -> None:
        message = self._decoder.decode(packet.payload)
        if message is not None and self.newest.accept(message, packet.arrived_ns):
            self.message = message

    def age(self, now_ns: int) -> float:
        return NEVER if self.message is None else max(0.0, (now_ns - self.newest.arrived_ns) * 1e-9)


class Picture:
    """Args:
    robot: the robot's name.
    """

    def __init__(self, robot: str) -> None:
        self._slots = {
            report_key(robot): _Slot(ControlReport),
            mirror_key(robot, "state"): _Slot(RobotState),
            mirror_key(robot, "scene"): _Slot(Scene),
            mirror_key(robot, "description"): _Slot(RobotDescription),
            mirror_key(robot, "command"): _Slot(VelocityCommand),
        }
        self.keys = list(self._slots)

    def take(self, packet: Packet) -> None:
        """Take one packet; what is no message of its key is left out."""
        slot = self._slots.get(packet.key)
        if slot is not None:
            slot.take(packet)

    def ages(self, now_ns: int) -> tuple[float, float]:
        """Of report and state (s); a state that was old already when it was sent is older than its arrival."""
        report, state = (self._slots[key].age(now_ns) for key in self.keys[:2])
        return report, state + (self.state.sample_age if self.state is not None else 0.0)

    @property
    def report(self) -> ControlReport | None:
        """The operator's newest."""
        found = self._slots[self.keys[0]].message
        return found if isinstance(found, ControlReport) else None

    @property
    def state(self) -> RobotState | None:
        """The robot's newest."""
        found = self._slots[self.keys[1]].message
        return found if isinstance(found, RobotState) else None

    @property
    def scene(self) -> Scene | None:
        """What is around it."""
        found = self._slots[self.keys[2]].message
        return found if isinstance(found, Scene) else None

    @property
    def description(self) -> RobotDescription | None:
        """What it is."""
        found = self._slots[self.keys[3]].message
        return found if isinstance(found, RobotDescription) else None

    @property
    def command(self) -> VelocityCommand | None:
        """The operator's newest, as it left."""
        found = self._slots[self.keys[4]].message
        return found if isinstance(found, VelocityCommand) else None

    @property
    def path(self) -> list[Vector3]:
        """The committed path (m, base): where the robot will be by the newest command, to the stop at its end."""
        report, command = self.report, self.command
        if report is None or command is None or command.mode != "run":
            return []
        dt = command.plan_period_ns * 1e-9
        steps = (command.velocity, *command.plan)

        def further(at: Vector3, v: Vector3) -> Vector3:
            return (at[0] + v[0] * dt, at[1] + v[1] * dt, at[2] + v[2] * dt)

        return list(accumulate(steps, further, initial=report.predicted))
