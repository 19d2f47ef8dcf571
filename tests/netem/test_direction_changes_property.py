"""Whatever is done to robots' networks while messages pass: every message is accounted for, and it repeats."""

import json

import msgspec
from hypothesis import given, settings
from hypothesis import strategies as st

from farhand.common.errors import InputError
from farhand.common.link.link import Packet, memory_wire
from farhand.netem.action import Action
from farhand.netem.emulation import Emulation
from farhand.netem.netem_node import NetemNode
from farhand.netem.spec import parse_spec

MS = 1_000_000
SPECS = ("none", "gaussian:20,20 loss:20%", "rate:50kbit,2kB constant:5", "duplicate:30% uniform:1,50",
         "tcp-like loss:30%", "outage:random(50,20,hold)", "slot:5,20")  # fmt: skip
ROBOTS = st.sampled_from(["", "a", "b", "c"])
ACTIONS = st.builds(
    dict,
    do=st.sampled_from(["set", "add", "remove", "outage", "reset", "common"]),
    direction=st.sampled_from(["both", "uplink", "downlink"]),
    robot=ROBOTS,
    spec=st.sampled_from(SPECS),
    hold=st.booleans(),
)
STEPS = st.lists(st.tuples(st.integers(1, 60), ACTIONS), max_size=12)


def run(steps):
    """Statistics after 40 bursts of messages with the changes in between, and what arrived when."""
    operator, operator_end = memory_wire()
    robot, robot_end = memory_wire()
    common = parse_spec("gaussian:20,10 loss:5%")
    own = {"b": {"uplink": parse_spec("constant:30")}}
    node = NetemNode(operator_end, robot_end, Emulation(common, common, 7, own))
    due, arrived = list(steps), []
    for tick in range(1, 400):
        now_ns = tick * 5 * MS
        while due and due[0][0] <= tick:
            wanted = dict(due.pop(0)[1])
            if wanted["do"] not in ("set", "add"):
                wanted.pop("spec")
            wanted |= {"length": 0.05} if wanted["do"] == "outage" else {}
            wanted |= {"name": "loss"} if wanted["do"] == "remove" else {}
            try:
                Action(**wanted).perform(node, now_ns)
            except InputError:
                pass  # such as nothing to remove
        if tick <= 60:
            for name in ("a", "b", "c"):
                operator.send(Packet(f"farhand/{name}/command", bytes(100), now_ns))
                robot.send(Packet(f"farhand/{name}/state", bytes(100), now_ns))
        node.step(now_ns)
        node.check_conservation()
        arrived += [(tick, packet.key) for end in (operator, robot) for packet in end.receive()]
    return json.dumps(msgspec.to_builtins(node.statistics()), sort_keys=True), arrived


@settings(max_examples=25)
@given(STEPS)
def test_conserved_and_repeatable_under_any_changes(steps):
    steps = sorted(steps, key=lambda step: step[0])
    first = run(steps)
    assert first == run(steps)
    received = json.loads(first[0])["uplink"]["robots"]
    assert {name: received[name]["received"] for name in received} == {"a": 60, "b": 60, "c": 60}
