"""The whole operator's side, driving, is told one thing more of the robot: it goes on deciding, within its limits."""

import math
from collections.abc import Callable

import msgspec

from farhand.common.link.link import Packet, memory_wire
from farhand.common.messages.base import Echo
from farhand.common.messages.codec import Decoder, encode
from farhand.common.messages.command import VelocityCommand
from farhand.common.messages.keys import description_key, scene_key, state_key
from farhand.operator_side.control.registry import make_controller
from farhand.operator_side.operator_node import OperatorIdentity, OperatorNode
from farhand.operator_side.prepare import prepare
from farhand.operator_side.steering.registry import make_device
from farhand.runs.scenario import load_scenario
from farhand.trials.fuzz.target import Target, check
from farhand.trials.fuzz.targets.wire.operator_messages import description, scene, state

OPERATOR = 1_000_007
PERIOD_NS = 100_000_000
START_NS = 1_000_000_000
KEYS = (state_key("r"), scene_key("r"), description_key("r"))


def seeds() -> list[bytes]:
    """The robot's next messages, behind the number of their key."""
    later = {"seq": 60, "t_sent_ns": 1_000_000_000, "t_sample_ns": 1_000_000_000}
    pictures = [state(**later), state(**later, mode="stopped", reason="x"), scene(**later)]
    pictures.append(scene(**later, obstacles=(), targets=()))
    bodies = [(1 if hasattr(each, "targets") else 0, each) for each in pictures]
    told = [bytes([number]) + msgspec.msgpack.encode(each) for number, each in bodies]
    return [*told, b"\2" + msgspec.msgpack.encode(description(seq=60))]


def start() -> Callable[[bytes], None]:
    """See Target."""
    scenario = load_scenario("point-obstacle")
    controller = make_controller(scenario.controller)
    prepare(controller)
    limits, decoder = scenario.controller.speed_limit, Decoder(VelocityCommand)
    lawful = [encode(scene()), encode(description())]

    def take(data: bytes) -> None:
        controller.reset()
        robot, link = memory_wire()
        node = OperatorNode(
            scenario, controller, make_device(scenario.steering), link, OperatorIdentity("r", OPERATOR)
        )
        robot.send(Packet(KEYS[1], lawful[0], START_NS))
        robot.send(Packet(KEYS[2], lawful[1], START_NS))
        for tick in range(5):
            now_ns = START_NS + tick * PERIOD_NS
            echo = Echo(OPERATOR, tick - 1, now_ns - PERIOD_NS, 1_000_000) if tick else None
            told = state(
                seq=40 + tick,
                t_sent_ns=now_ns // 2,
                t_sample_ns=now_ns // 2,
                echo=echo,
                applied_seq=max(0, tick - 1),
            )
            if tick == 2 and data:
                robot.send(Packet(KEYS[data[0] % 3], data[1:], now_ns))
            robot.send(Packet(KEYS[0], encode(told), now_ns))
            node.step(now_ns)
            for packet in robot.receive():
                command = decoder.decode_or_raise(packet.payload)
                for velocity in (command.velocity, *command.plan):
                    check(all(map(math.isfinite, velocity)), "a command is not finite")
                    check(
                        all(abs(v) <= limit + 1e-6 for v, limit in zip(velocity, limits, strict=True)),
                        f"a command of {velocity} m/s is faster than the limit",
                    )
        check(not node.fault, f"the operator's program stands: {node.fault}")

    return take


TARGET = Target(
    edge="the whole operator's side: five ticks with prediction, margin and MPC",
    promise="it goes on, and what it commands is finite and within the limits",
    seeds=seeds,
    start=start,
    shape="map",
    head=1,
    longest=8192,
)
