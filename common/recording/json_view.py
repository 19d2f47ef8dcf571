"""Every message of ours as JSON with a named schema, for programs that read MCAP and know nothing of us."""

from collections.abc import Iterator
from typing import Any, Protocol

import msgspec

from farhand.common.messages.base import Message
from farhand.common.messages.camera import CameraFrame
from farhand.common.messages.command import VelocityCommand
from farhand.common.messages.description import RobotDescription
from farhand.common.messages.report import ControlReport
from farhand.common.messages.scene import Scene
from farhand.common.messages.state import RobotState
from farhand.common.recording.decoded import DecodedTick
from farhand.common.recording.mcap_file import ChannelSpec

DIGITS = 6
"""Of a number in JSON; the exact bytes stand beside."""
_SHORT = f"%.{DIGITS}g"
Said = tuple[str, int, bytes]
"""Topic, stamp on the operator's clock (ns), bytes."""

TOPICS: dict[str, tuple[str, type[Message]]] = {
    "report": ("/operator/report", ControlReport),
    "command": ("/operator/command", VelocityCommand),
    "state": ("/robot/state", RobotState),
    "scene": ("/robot/scene", Scene),
    "description": ("/robot/description", RobotDescription),
}


CAMERA = "/robot/camera"
_CAMERA = b'{"type":"object","description":"a CameraFrame, with the bytes of its picture counted"}'


class View(Protocol):
    """A way to tell of a run beside its bytes."""

    @property
    def channels(self) -> tuple[ChannelSpec, ...]:
        """The topics that it fills."""
        ...

    def tick(self, tick: DecodedTick) -> Iterator[Said]:
        """What it says of one tick."""
        ...

    def frame(self, frame: CameraFrame, stamp_ns: int) -> Iterator[Said]:
        """What it says of a picture that came then."""
        ...


class JsonView:
    """See the module."""

    def __init__(self) -> None:
        told = tuple(json_channel(topic, kind) for topic, kind in TOPICS.values())
        self.channels = (*told, ChannelSpec(CAMERA, "json", "farhand.CameraFrame", "jsonschema", _CAMERA))
        self._encoder = msgspec.json.Encoder()

    def tick(self, tick: DecodedTick) -> Iterator[Said]:
        """See View."""
        for arrived_ns, kind, message in tick.arrived:
            yield TOPICS[kind][0], arrived_ns, self._encode(message)
        now_ns = tick.record.now_ns
        if tick.command is not None:
            yield TOPICS["command"][0], now_ns, self._encode(tick.command)
        if tick.report is not None:
            yield TOPICS["report"][0], now_ns, self._encode(tick.report)

    def frame(self, frame: CameraFrame, stamp_ns: int) -> Iterator[Said]:
        """See View; the picture itself is none of JSON's."""
        told = msgspec.to_builtins(frame, builtin_types=(bytes,))
        told["jpeg"] = len(frame.jpeg)
        yield CAMERA, stamp_ns, self._encoder.encode(told)

    def _encode(self, message: Message) -> bytes:
        return self._encoder.encode(shortened(msgspec.to_builtins(message)))


def shortened(node: Any) -> Any:
    """Plain values, numbers to six digits: the last ones of a float fill a disk and tell nobody anything."""
    kind = type(node)
    if kind is float:
        return float(_SHORT % node)
    if kind is dict:
        return {key: shortened(value) for key, value in node.items()}
    if kind is list or kind is tuple:  # most are vectors: a call for each number would be half of the time
        return [float(_SHORT % each) if type(each) is float else shortened(each) for each in node]
    return node


def json_channel(topic: str, kind: Any) -> ChannelSpec:
    """A channel of JSON objects of one kind, its schema written out (viewers follow no references)."""
    schema = msgspec.json.schema(kind)
    definitions = schema.pop("$defs", {})
    whole = _written_out(schema, definitions)
    return ChannelSpec(topic, "json", f"farhand.{kind.__name__}", "jsonschema", msgspec.json.encode(whole))


def _written_out(node: Any, definitions: dict[str, Any]) -> Any:
    if isinstance(node, list):
        return [_written_out(each, definitions) for each in node]
    if not isinstance(node, dict):
        return node
    if "$ref" in node:
        return _written_out(definitions[node["$ref"].rpartition("/")[2]], definitions)
    return {key: _written_out(value, definitions) for key, value in node.items()}
