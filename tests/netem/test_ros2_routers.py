"""Two ROS 2 nodes, each at a router of its own, and nothing between the routers but the emulator."""

import csv
import threading

import pytest

from farhand.bridges.ros2.cdr.types import Types
from farhand.bridges.ros2.graph.node import RosNode
from farhand.bridges.ros2.graph.wire import LATCHED, RELIABLE, read_attachment
from farhand.common.link.ports import free_ports
from farhand.common.link.zenoh_link import open_session
from farhand.common.timing.clock import SystemClock, to_ns
from farhand.testing import Programs
from tests.farhand.bridges.ros2.peer import PATIENCE, Peer, router

pytestmark = pytest.mark.realtime
STRING, TRIGGER = "std_msgs/msg/String", "std_srvs/srv/Trigger"
SECOND = 1_000_000_000
COUNT = 60


@pytest.fixture
def rig(tmp_path):
    near, far = free_ports(2)
    clock = SystemClock()
    with router(near), router(far), Peer(far) as peer, Programs(tmp_path) as programs:
        emulator = programs.start("netem", "--network", "uniform:50,200", "--router", "--log", tmp_path / "log.csv",
                                  "--connect-operator", f"tcp/127.0.0.1:{near}",
                                  "--connect-robot", f"tcp/127.0.0.1:{far}")  # fmt: skip
        emulator.wait_for("connects to")
        session = open_session(
            [f"tcp/127.0.0.1:{near}"], mode="client", extra=[("timestamping/enabled", True)]
        )
        node = RosNode(
            session, Types("jazzy"), clock, domain=0, namespace="", name="talker", wake=lambda: None
        )

        def drawn():
            assert emulator.interrupt(30) == 0
            rows = csv.DictReader((tmp_path / "log.csv").read_text().splitlines())
            return [row for row in rows if row["key"].startswith("0/chatter/")]

        yield node, peer, clock, drawn
        session.close()


def test_two_ros_nodes_talk_through_the_emulator_and_the_drawn_delays_are_those_that_arrive(rig):
    node, peer, clock, drawn = rig
    make = node.types.make
    arrived = {}

    def take(sample):
        found = read_attachment(sample.attachment.to_bytes())
        arrived[found.seq] = clock.now_ns() + clock.epoch_ns() - found.sent_ns

    publisher = node.publisher("/chatter", STRING, RELIABLE)
    latched = node.publisher("/told_before", STRING, LATCHED)
    latched.put(make(STRING, data="for who comes late"))
    calls = []

    def serve(call):
        calls.append(call)
        call.answer(success=True, message="heard")

    node.serve("/ask", TRIGGER, serve, pytest.fail)

    # The graph, attachments and a topic: the far node knows of the near one by its tokens alone.
    heard = peer.listen("/chatter", STRING)
    subscriber = peer.session.session.declare_subscriber("0/chatter/**", take)
    pause = threading.Event()
    while not any("/talker" in token for token in peer.tokens()):
        pause.wait(0.1)
    while heard.empty() or not arrived:
        publisher.put(make(STRING, data="hello"))
        pause.wait(0.1)
    begin = publisher.sent
    end_ns = clock.now_ns() + to_ns(PATIENCE)
    while len([seq for seq in arrived if seq > begin]) < COUNT:  # a busy machine's link may drop one
        assert clock.now_ns() < end_ns, sorted(arrived)
        publisher.put(make(STRING, data="counted"))
        pause.wait(0.01)
    settled_ns = clock.now_ns() + SECOND
    while (
        len([seq for seq in arrived if seq > begin]) < publisher.sent - begin and clock.now_ns() < settled_ns
    ):
        pause.wait(0.01)
    took = sorted(arrived[seq] for seq in arrived if seq > begin)

    # A service, there and back; and what was told before.
    assert peer.call("/ask", TRIGGER).message == "heard"
    assert len(calls) == 1
    late = peer.listen("/told_before", STRING, qos=LATCHED.text)
    assert late.get(timeout=PATIENCE).data == "for who comes late"
    subscriber.undeclare()

    # What was drawn for each of the counted messages is what it took, from the slowest on; a link may have dropped one.
    rows = sorted(drawn(), key=lambda row: int(row["ordinal"]))[begin - publisher.sent :]
    assert {row["fate"] for row in rows} == {"delivered"}
    asked = sorted(int(row["drawn_ns"]) for row in rows)
    assert 50e6 <= asked[0] < asked[-1] <= 200e6
    over = []
    for got in reversed(took):
        while asked[-1] > got + 1e6:
            asked.pop()
        over.append(got - asked.pop())
    assert sorted(over)[len(over) // 2] < 20e6, over
