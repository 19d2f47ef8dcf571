"""Each robot its own network over one emulator."""

from common.link import Packet, memory_wire
from netem.netem_node import NetemNode
from netem.spec import parse_spec


def test_one_robots_own_network():
    operator, operator_end = memory_wire()
    robot, robot_end = memory_wire()
    none = parse_spec("none")
    own = {"arm2": parse_spec("constant:100"), "arm3": parse_spec("loss:100%")}
    node = NetemNode(operator_end, robot_end, none, none, 1, robot_networks=own)
    for name in ("arm1", "arm2", "arm3"):
        operator.send(Packet(f"farhand/{name}/command", b"x", 1))
    next_ns = node.step(1)
    assert [p.key for p in robot.receive()] == ["farhand/arm1/command"]
    assert next_ns == 100_000_001
    node.step(next_ns)
    assert [p.key for p in robot.receive()] == ["farhand/arm2/command"]
    assert node.conserved()
    assert node.statistics()["uplink"]["robot_specs"] == {"arm2": "constant:100", "arm3": "loss:100%"}
