"""A recorded tick as messages, decoded once for all who write or read something of it."""

from dataclasses import dataclass
from typing import Any

from farhand.common.messages.base import Message
from farhand.common.messages.codec import Decoder
from farhand.common.messages.command import VelocityCommand
from farhand.common.messages.description import RobotDescription
from farhand.common.messages.echo import LEFT_NS, Newest
from farhand.common.messages.keys import kind_of
from farhand.common.messages.report import ControlReport
from farhand.common.messages.scene import Scene
from farhand.common.messages.state import RobotState
from farhand.common.recording.records import TickRecord

ARRIVING: dict[str, type[Message]] = {
    "state": RobotState,
    "scene": Scene,
    "description": RobotDescription,
}
"""What comes from the robot, by the kind that its key names."""


@dataclass(frozen=True, slots=True)
class DecodedTick:
    """Attributes:
    record: as recorded.
    report: what was seen and decided; None: unreadable.
    command: what was sent; None: nothing, or unreadable.
    arrived: (arrived_ns, kind, message) of what came and is readable, in order.
    news: the same without what a newer message of its kind had overtaken, of this sender or of one that followed it.
    """

    record: TickRecord
    report: ControlReport | None
    command: VelocityCommand | None
    arrived: tuple[tuple[int, str, Message], ...]
    news: tuple[tuple[int, str, Message], ...]


class TickDecoder:
    """Decodes ticks; what is unreadable is left out here and stays in the recording."""

    def __init__(self) -> None:
        self._report, self._command = Decoder(ControlReport), Decoder(VelocityCommand)
        self._arriving: dict[str, Decoder[Any]] = {kind: Decoder(each) for kind, each in ARRIVING.items()}
        self._newest = {kind: Newest(LEFT_NS) for kind in ARRIVING}

    def decode(self, record: TickRecord) -> DecodedTick:
        """The messages of one tick."""
        arrived, news = [], []
        for key, arrived_ns, payload in record.packets:
            kind = kind_of(key)
            decoder = self._arriving.get(kind)
            message = decoder.decode(payload) if decoder is not None else None
            if message is not None:
                arrived.append((arrived_ns, kind, message))
                if self._newest[kind].accept(message, arrived_ns):
                    news.append(arrived[-1])
        command = None if record.command is None else self._command.decode(record.command)
        return DecodedTick(record, self._report.decode(record.report), command, tuple(arrived), tuple(news))
