"""A robot that an operator drives is sent one thing more: what moves must be explained by what may move it."""

import math
from collections.abc import Callable
from typing import Any

import msgspec

from farhand.common.link.link import Packet
from farhand.common.messages.base import Echo
from farhand.common.messages.codec import encode
from farhand.common.messages.command import VelocityCommand
from farhand.common.messages.keys import command_key
from farhand.robot_side.safety.command_intake import CommandIntake
from farhand.robot_side.safety.settings import SafetySettings
from farhand.robot_side.safety.watchdog import Watchdog
from farhand.trials.fuzz.target import Target, check

ROBOT, OPERATOR, OTHER = 1_000_009, 1_000_007, 1_000_003
NOW_NS, LAWFUL_SEQ = 5_000_000_000, 5
KEY = command_key("r")
SETTINGS = SafetySettings()


def command(seq: int = LAWFUL_SEQ, session: int = OPERATOR, age_ns: int = 50_000_000, **fields: Any) -> bytes:
    """A command's bytes, without the checksum, which a mutation would break."""
    made: dict[str, Any] = {
        "source": "alice",
        "session": session,
        "seq": seq,
        "t_sent_ns": seq * 100_000_000,
        "echo": Echo(ROBOT, 3, NOW_NS - age_ns, 1_000_000),
        "mode": "run",
        "velocity": (0.2, 0.0, 0.0),
    }
    return msgspec.msgpack.encode(VelocityCommand(**(made | fields)))


def seeds() -> list[bytes]:
    """Good ones, and one of each kind that is refused."""
    turns: dict[str, Any] = {
        "angular": (0.1, 0.0, 0.0),
        "plan": ((0.1, 0.0, 0.0),) * 9,
        "plan_angular": ((0.1, 0.0, 0.0),) * 9,
    }
    whole = VelocityCommand(
        source="alice", session=OPERATOR, seq=9, t_sent_ns=9, echo=Echo(ROBOT, 3, NOW_NS, 0), mode="run",
        velocity=(0.3, 0.0, 0.0),
    )  # fmt: skip
    modes = [command(6, mode=mode) for mode in ("hold", "estop", "acknowledge", "release")]
    return [
        *modes,
        command(6),
        command(7, **turns),
        command(5),
        command(6, session=OTHER),
        command(6, session=OTHER, mode="acknowledge"),
        command(6, mode="release", successor=OTHER),
        command(6, age_ns=2_000_000_000),
        command(6, echo=None),
        command(6, velocity=(2.5, 0.0, 0.0)),
        encode(whole),
    ]


def start() -> Callable[[bytes], None]:
    """See Target."""
    lawful = command()

    def take(data: bytes) -> None:
        watchdog = Watchdog(SETTINGS, ROBOT)
        intake = CommandIntake("r", watchdog)
        intake.take([Packet(KEY, lawful, NOW_NS)], NOW_NS)
        check(watchdog.mode == "run", "the lawful operator does not drive")
        before = watchdog.twist(NOW_NS)
        intake.take([Packet(KEY, data, NOW_NS)], NOW_NS)
        watchdog.tick(NOW_NS)
        _judge(watchdog, before, data)

    return take


def _judge(watchdog: Watchdog, before: tuple[Any, Any], data: bytes) -> None:
    """By rules of its own, from the bytes alone."""
    after = watchdog.twist(NOW_NS)
    check(all(map(math.isfinite, (*after[0], *after[1]))), "a twist is not finite")
    check(max(map(abs, after[0])) <= SETTINGS.max_speed, "a twist is faster than the limit")
    if after == before and watchdog.mode == "run":
        return
    said = msgspec.msgpack.decode(data)  # what is no map at all must not have come so far
    if watchdog.mode == "estop":
        check(said["mode"] == "estop", "an emergency stop that nobody asked for")
        return
    check(said["session"] == OPERATOR, "moved or stopped by a foreign session")
    check(said["seq"] > LAWFUL_SEQ, "moved or stopped by an old number")
    if watchdog.mode == "run":
        _judge_motion(said, after)


def _judge_motion(said: dict[str, Any], after: tuple[Any, Any]) -> None:
    check(said["mode"] == "run", f"moved by a command {said['mode']!r}")
    echo = said["echo"]
    session, sent_ns = (echo["session"], echo["t_sent_ns"])
    check(session == ROBOT, "moved by a command that was built on another robot's state")
    check(0 <= NOW_NS - sent_ns <= 1_000_000_000, "moved by a stale command")
    check(tuple(map(float, said["velocity"])) == after[0], "moved otherwise than commanded")


TARGET = Target(
    edge="commands at the robot: codec, intake, watchdog",
    promise="moved only by the session in control, newer, built on a fresh state, within the limits",
    seeds=seeds,
    start=start,
    shape="map",
    longest=8192,
)
