"""An operator's reports, as whoever watches it receives them over Zenoh."""

from dataclasses import dataclass

from farhand.common.link.zenoh_link import ZenohLink, open_session
from farhand.common.messages.codec import Decoder
from farhand.common.messages.command import VelocityCommand
from farhand.common.messages.keys import command_key, kind_of, mirror_key, report_key, scene_key
from farhand.common.messages.report import ControlReport
from farhand.common.messages.scene import Scene
from farhand.common.timing.clock import SystemClock


@dataclass(frozen=True, slots=True)
class Arrived:
    """A report, and when it came on the reader's clock."""

    report: ControlReport
    at_ns: int


class ReportReader:
    """Receives an operator's reports over Zenoh.

    Args:
        connect: the operator's report endpoint.
        name: the robot's name.
        clock: of this process.

    Attributes:
        released: session that gave control up to nobody, as an operator's program does when it ends; 0: none did.
        scenes: of the robot, that came with the last `read`, and when (ns).
    """

    def __init__(self, connect: str, name: str, clock: SystemClock) -> None:
        self._commands = mirror_key(name, kind_of(command_key(name)))
        self._scenes = mirror_key(name, kind_of(scene_key(name)))
        keys = [report_key(name), self._commands, self._scenes]
        self.link = ZenohLink(open_session([connect]), keys, clock)
        self._decoder, self._scene_decoder = Decoder(ControlReport), Decoder(Scene)
        self._command_decoder = Decoder(VelocityCommand)
        self.released = 0
        self.scenes: list[tuple[Scene, int]] = []

    def read(self) -> list[Arrived]:
        """Reports since the last call."""
        packets = []
        self.scenes = []
        for packet in self.link.receive():
            if packet.key == self._scenes:
                scene = self._scene_decoder.decode(packet.payload)
                self.scenes += [(scene, packet.arrived_ns)] if scene is not None else []
                continue
            if packet.key != self._commands:
                packets.append(packet)
                continue
            command = self._command_decoder.decode(packet.payload)
            if command is not None and command.mode == "release" and not command.successor:
                self.released = command.session
        found = [(self._decoder.decode(packet.payload), packet.arrived_ns) for packet in packets]
        return [Arrived(report, at_ns) for report, at_ns in found if report is not None]

    def connected(self) -> bool:
        """Whether the operator's program is connected."""
        return self.link.connected()

    def close(self) -> None:
        """Close the session."""
        self.link.close()
