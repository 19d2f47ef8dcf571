"""What hands say to the operator's program: one drives, and a further message comes."""

import math
from collections.abc import Callable
from typing import Any

import msgspec

from farhand.common.link.link import Packet, memory_wire
from farhand.common.messages.keys import steering_key
from farhand.common.messages.steering import Steering
from farhand.operator_side.steering.device import View
from farhand.operator_side.steering.hand.remote import Remote
from farhand.operator_side.steering.targets import Targets
from farhand.trials.fuzz.target import Target, check
from farhand.trials.fuzz.targets.wire.operator_messages import scene, state

DRIVER, OTHER = 2_000_003, 2_000_005
MS = 1_000_000
NOW_NS = 5_000_000_000


def steering(seq: int, session: int = DRIVER, **fields: Any) -> bytes:
    """A hand's message without a checksum."""
    made: dict[str, Any] = {
        "source": "console", "session": session, "seq": seq, "t_sent_ns": NOW_NS + seq * 10 * MS, "device": "keys"
    }  # fmt: skip
    return msgspec.msgpack.encode(Steering(**(made | fields)))


def seeds() -> list[bytes]:
    """Each wish once, of the driver and of another."""
    wishes: list[dict[str, Any]] = [
        {"engaged": True, "press": 2, "linear": (1.0, 0.0, 0.0)},
        {"engaged": True, "press": 1, "linear": (0.5, 0.5, 0.0), "frame": "tool", "scale": 0.5},
        {"estop": True},
        {"acknowledge": True},
        {"take": True},
        {"release": True},
        {"engaged": True, "press": 3, "unit": "si", "angular": (0.1, 0.0, 0.0), "frame": "view"},
    ]
    return [steering(9, session, **wish) for session in (DRIVER, OTHER) for wish in wishes]


def start() -> Callable[[bytes], None]:
    """See Target."""
    robot, around, targets = state(), scene(), Targets(0.02)

    def take(data: bytes) -> None:
        hand, (sender, receiver) = Remote(), memory_wire()
        hand.listen(receiver)

        def say(payload: bytes, at_ns: int) -> Any:
            sender.send(Packet(steering_key("r"), payload, at_ns))
            return hand.read(View(robot, around, targets, at_ns))

        say(steering(1, take=True), NOW_NS + 10 * MS)
        before = say(steering(2, engaged=False, press=1), NOW_NS + 20 * MS)
        check(not before.engaged, "it moves without a press")
        after = say(data, NOW_NS + 90 * MS)
        check(all(map(math.isfinite, (*after.velocity, *after.angular))), "a wish is not finite")
        if after.engaged:
            said = msgspec.msgpack.decode(data)
            check(said["session"] == DRIVER, "moved by a hand that has not the wheel")
            check(said["engaged"] is True and said["seq"] > 2, "moved by what presses nothing, or is old")
        later = hand.read(View(robot, around, targets, NOW_NS + 400 * MS))
        check(not later.engaged, "it moves on after 0.15 s without a word")

    return take


TARGET = Target(
    edge="steering messages at the operator's program",
    promise="motion only by a new press of who has the wheel, and not 0.15 s after it",
    seeds=seeds,
    start=start,
    shape="map",
)
