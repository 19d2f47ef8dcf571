"""CDR bytes from a ROS 2 graph: twists and joysticks."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from farhand.bridges.ros2.cdr.twists import TWIST
from farhand.bridges.ros2.cdr.types import Types
from farhand.bridges.ros2.graph.node import Heard
from farhand.bridges.ros2.graph.wire import Attachment, data_key
from farhand.bridges.ros2.inbound.reading import (
    FAST,
    JOY,
    Reader,
    RefusedError,
    TwistFrames,
    inputs_of,
)
from farhand.trials.fuzz.target import Target, check

STAMP = Attachment(1, 1, b"g" * 16)


def seeds() -> list[bytes]:
    """A twist and a joystick's state, and an attachment."""
    types = Types("jazzy")
    header = types.make(
        "std_msgs/msg/Header",
        stamp=types.make("builtin_interfaces/msg/Time", sec=1, nanosec=2),
        frame_id="base",
    )
    vector: Any = types.make("geometry_msgs/msg/Vector3", x=0.1, y=0.0, z=0.0)
    twist = types.make(
        TWIST, header=header, twist=types.make("geometry_msgs/msg/Twist", linear=vector, angular=vector)
    )
    joy = types.make(
        JOY, header=header, axes=np.zeros(8, np.float32), buttons=np.zeros(11, np.int32)
    )  # fmt: skip
    return [b"\0" + types.encode(twist, TWIST), b"\1" + types.encode(joy, JOY), b"\2" + STAMP.to_bytes()]


def start() -> Callable[[bytes], None]:
    """See Target."""
    types, frames = Types("jazzy"), TwistFrames("base", "tool")
    keys = [data_key(0, "/topic", kind, types.hash_of(kind)) for kind in (TWIST, JOY)]
    readers = [Reader(types, kind, key) for kind, key in zip((TWIST, JOY), keys, strict=True)]

    def take(data: bytes) -> None:
        which = data[0] % 3 if data else 0
        kind, attachment = which % 2, STAMP.to_bytes()
        payload = data[1:]
        if which == 2:
            attachment, payload = payload, b""
        try:
            stamp, message = readers[kind].read(Heard(keys[kind], payload, attachment, 1))
            if kind == 0:
                wanted = frames.wanted(message, stamp)
                check(
                    all(math.isfinite(v) and abs(v) < FAST for v in (*wanted.linear, *wanted.angular)),
                    "too fast",
                )
            else:
                found = inputs_of(message, stamp)
                check(all(-1.0 <= value <= 1.0 for value in found.values()), "an input is not from -1 to 1")
        except RefusedError as error:
            check(
                bool(error.reason) and len(str(error)) < 10_000, "a refusal without a word, or with too many"
            )

    return take


TARGET = Target(
    edge="CDR and attachments from ROS 2: TwistStamped, Joy",
    promise="what comes through is finite and within bounds; all else is refused by a reason",
    seeds=seeds,
    start=start,
    head=1,
    longest=2048,
)
