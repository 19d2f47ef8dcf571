"""Requests that change the emulated network while it runs."""

from collections.abc import Callable

import msgspec

from farhand.common.link.link import Packet, memory_wire
from farhand.netem.control import handle
from farhand.netem.emulation import Emulation
from farhand.netem.netem_node import NetemNode
from farhand.netem.spec import parse_spec
from farhand.trials.fuzz.target import Target, check


def seeds() -> list[bytes]:
    """One of each deed."""
    deeds: list[dict[str, object]] = [
        {"do": "show"},
        {"do": "set", "direction": "uplink", "spec": "gaussian:80,20 loss:1%"},
        {"do": "add", "spec": "corrupt:1%", "robot": "arm2"},
        {"do": "remove", "name": "loss"},
        {"do": "outage", "length": 2.0, "hold": True},
        {"do": "reset"},
        {"do": "common", "robot": "r"},
    ]
    return [msgspec.json.encode(deed) for deed in deeds]


def start() -> Callable[[bytes], None]:
    """See Target."""
    spec = parse_spec("constant:5 loss:1%")

    def take(data: bytes) -> None:
        (operator, operator_end), (robot_end, _) = memory_wire(), memory_wire()
        node = NetemNode(operator_end, robot_end, Emulation(spec, spec, 1))
        operator.send(Packet("farhand/r/command", b"abc", 1))
        node.step(1)
        before = {name: str(direction.chain.spec) for name, direction in node.directions.items()}
        said = msgspec.json.decode(handle(node, data, 2))
        after = {name: str(direction.chain.spec) for name, direction in node.directions.items()}
        check(isinstance(said, dict) and isinstance(said.get("ok"), bool), "an answer is none")
        check(said["ok"] or (before == after and node.changes == 0), "what was refused has changed something")
        node.step(10**10)
        node.check_conservation()

    return take


TARGET = Target(
    edge="live control of netem",
    promise="what is refused changes nothing; no message is lost count of",
    seeds=seeds,
    start=start,
    shape="json",
    longest=2048,
)
