"""Laws of the emulator: never early, nothing vanishes, in order where it says so."""

import msgspec
from hypothesis import given, settings
from hypothesis import strategies as st

from farhand.common.link.link import Packet, memory_wire
from farhand.common.recording.fates import DELIVERED
from farhand.netem.emulation import Emulation
from farhand.netem.impairments.base import Flow, Transit
from farhand.netem.netem_node import NetemNode
from farhand.netem.release_queue import Limits, ReleaseQueue
from farhand.netem.spec import parse_spec

MS = 1_000_000
FLOW = Flow("k", "r", "other", [], [], [])
SPECS = st.sampled_from(
    [
        "none",
        "gaussian:20,10",
        "uniform:0,40,50% loss:20% duplicate:20%",
        "rate:50kbit,1kB gaussian:5,5 corrupt:30%",
        "slot:7,13,2 lognormal:10,20 reorder:gap(3,50%)",
        "outage:random(30ms,20ms,hold) constant:3",
        "outage:every(50ms,20ms) loss:gilbert(20%,50%) tcp-like:30 pareto:10,5",
    ]
)


@given(st.lists(st.tuples(st.integers(0, 50), st.integers(0, 30)), max_size=60))
def test_queue_releases_in_order_of_time_then_arrival_and_never_early(operations):
    queue = ReleaseQueue(Limits(messages=40, size=500))
    now, waiting, released = 0, [], []
    for number, (delay, step) in enumerate(operations):
        transit = Transit(Packet("k", b""), FLOW, delay, number, now, now + delay)
        if queue.push(transit):
            waiting.append((now + delay, number))
        else:
            assert len(waiting) >= 40 or sum(operations[n][0] for _, n in waiting) + delay > 500
        now += step
        while (due := queue.pop_due(now)) is not None:
            assert due.release_ns <= now
            released.append(due.ordinal)
            assert (due.release_ns, due.ordinal) == min(waiting)
            waiting.remove((due.release_ns, due.ordinal))
        assert not waiting or min(waiting)[0] > now
        assert len(queue) == len(waiting)
        assert queue.next_ns() == (min(waiting)[0] if waiting else None)


class Record:
    def __init__(self):
        self.rows = []

    def record(self, fate):
        self.rows.append(fate)


arrivals = st.lists(
    st.tuples(
        st.integers(0, 15), st.booleans(), st.sampled_from(["a", "farhand/r/state", "b"]), st.integers(0, 300)
    ),
    min_size=1,
    max_size=80,
)


def drive(spec, messages, limits):
    operator, near = memory_wire()
    far, robot = memory_wire()
    log = Record()
    node = NetemNode(near, far, Emulation(parse_spec(spec), parse_spec(spec), 3, limits=limits), logs=[log])
    now = MS
    for pause, up, key, size in messages:
        now += pause * MS
        (operator if up else robot).send(Packet(key, bytes(size), now))
        node.step(now)
        node.check_conservation()
    while (due := node.step(now)) is not None:
        now = max(now, due)
        node.check_conservation()
    found = msgspec.to_builtins(node.statistics())
    for name in ("uplink", "downlink"):
        logged = [fate.achieved_ns >= 0 for fate in log.rows if fate.direction == name]
        assert logged.count(True) == found[name]["delivered"]
        assert logged.count(False) == sum(found[name]["dropped"].values())
    return node, log, (operator, robot)


@given(SPECS, arrivals, st.integers(1, 30))
@settings(max_examples=150, deadline=None)
def test_nothing_vanishes_and_nothing_is_early(spec, messages, capacity):
    node, log, ends = drive(spec, messages, Limits(messages=capacity))
    for fate in log.rows:
        assert fate.assigned_ns >= fate.drawn_ns or fate.fate != DELIVERED
        assert (fate.achieved_ns < 0) == (fate.fate != DELIVERED)
        assert fate.achieved_ns < 0 or fate.achieved_ns >= fate.assigned_ns
    found = msgspec.to_builtins(node.statistics())
    for name, end, up in (("uplink", ends[1], True), ("downlink", ends[0], False)):
        sent = sum(message[1] is up for message in messages)
        assert found[name]["received"] == sent
        assert found[name]["queued"] == 0
        assert len(end.receive()) == found[name]["delivered"]
        assert (
            found[name]["delivered"] + sum(found[name]["dropped"].values())
            == sent + found[name]["duplicated"]
        )


@given(st.sampled_from(["uniform:0,50", "lognormal:10,30", "gaussian:10,20 loss:20%"]), arrivals)
@settings(max_examples=100, deadline=None)
def test_in_order_never_reorders_a_key(spec, messages):
    _, log, _ = drive(f"{spec} reorder:in-order", messages, Limits())
    for direction in ("uplink", "downlink"):
        for key in {message[2] for message in messages}:
            order = [
                fate.number
                for fate in log.rows
                if (fate.direction, fate.key) == (direction, key) and fate.achieved_ns >= 0
            ]
            assert order == sorted(order)


@given(arrivals)
@settings(max_examples=100, deadline=None)
def test_tcp_like_never_reorders_anything(messages):
    _, log, _ = drive("loss:30% uniform:0,20 tcp-like:20", messages, Limits())
    for direction in ("uplink", "downlink"):
        arrived = [
            fate.arrived_ns for fate in log.rows if fate.direction == direction and fate.achieved_ns >= 0
        ]
        assert arrived == sorted(arrived)
