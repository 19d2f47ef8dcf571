"""Every kind of message at the decoder alone: the first thing that any byte from outside meets."""

from collections.abc import Callable
from typing import Any

import msgspec

from farhand.common.messages.base import SCHEMA, Message
from farhand.common.messages.camera import CameraFrame
from farhand.common.messages.codec import Decoder
from farhand.common.messages.command import VelocityCommand
from farhand.common.messages.description import RobotDescription
from farhand.common.messages.report import ControlReport
from farhand.common.messages.scene import Scene
from farhand.common.messages.scene_request import SceneRequest
from farhand.common.messages.state import RobotState
from farhand.common.messages.steering import Steering
from farhand.trials.fuzz.target import Target, check, finite
from farhand.trials.fuzz.targets.wire import operator_messages, robot_intake, scene_requests, steering

KINDS: tuple[type[Message], ...] = (
    VelocityCommand, RobotState, Scene, RobotDescription, Steering, CameraFrame, ControlReport,
    SceneRequest,
)  # fmt: skip
REASONS = {"length", "malformed", "checksum", "schema", "unknown-field", "non-finite", "type"}


def seeds() -> list[bytes]:
    """One of each kind, behind its number; the scene without a mesh, whose hull would take most of the time."""
    commands = [b"\0" + each for each in robot_intake.seeds()[:8]]
    others = [
        bytes([each[0] + 1 if each[0] < 3 else each[0] + 2]) + each[1:]
        for each in operator_messages.seeds()
        if b"mesh" not in each
    ]
    ball = operator_messages.scene(obstacles=operator_messages.scene().obstacles[:1])
    others.append(b"\2" + msgspec.msgpack.encode(ball))
    others += [b"\7" + each for each in scene_requests.seeds()[:2]]
    return [*commands, *others, *(b"\4" + each for each in steering.seeds()[:3])]


def start() -> Callable[[bytes], None]:
    """See Target."""
    decoders: list[Decoder[Any]] = [Decoder(kind) for kind in KINDS]

    def take(data: bytes) -> None:
        decoder = decoders[data[0] % len(decoders) if data else 0]
        message = decoder.decode(data[1:])
        if message is not None:
            check(message.schema == SCHEMA, "another schema came through")
            check(finite(msgspec.to_builtins(message)), "a number that is not finite came through")
        elif not decoder.refused.keys() <= REASONS:
            check(False, f"refused for {set(decoder.refused) - REASONS}")

    return take


TARGET = Target(
    edge="the codec alone: all eight kinds of message",
    promise="no number that is not finite, and no other schema, comes through; each refusal has one of seven reasons",
    seeds=seeds,
    start=start,
    shape="map",
    head=1,
)
