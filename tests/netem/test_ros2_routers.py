"""Two ROS 2 nodes, each at a router of its own, and nothing between the routers but the emulator."""

import threading

import pytest

from farhand.bridges.ros2.node import RosNode
from farhand.bridges.ros2.types import Types
from farhand.bridges.ros2.wire import LATCHED, RELIABLE, read_attachment
from farhand.common.link.ports import free_ports
from farhand.common.link.zenoh_link import open_session
from farhand.common.timing.clock import SystemClock
from farhand.common.timing.loop import RealtimeLoop
from farhand.netem.emulation import Emulation
from farhand.netem.measure.fate_history import FateHistory
from farhand.netem.netem_node import NetemNode
from farhand.netem.proxy import Meeting, Proxy
from farhand.netem.spec import parse_spec
from tests.farhand.bridges.ros2.peer import PATIENCE, Peer, router

pytestmark = pytest.mark.realtime
STRING, TRIGGER = "std_msgs/msg/String", "std_srvs/srv/Trigger"
COUNT = 60


class Between:
    """The emulator in this process, a neighbour of both routers."""

    def __init__(self, ports, spec):
        self.clock, self.fates, self.loop = SystemClock(), FateHistory(), None
        meetings = [Meeting(connect=(f"tcp/127.0.0.1:{port}",), router=True) for port in ports]
        self.proxy = Proxy(*meetings, self.clock, self.wake)
        links = self.proxy.operator_link, self.proxy.robot_link
        emulation = Emulation(parse_spec(spec), parse_spec(spec), 1)
        self.node = NetemNode(*links, emulation, logs=[self.fates], instant=self.clock.now_ns)
        self.loop = RealtimeLoop(self.node, self.clock, message_driven=True, realtime=False)
        self.thread = threading.Thread(target=self.loop.run)
        self.thread.start()

    def wake(self):
        if self.loop is not None:
            self.loop.notify()

    def close(self):
        self.loop.stop()
        self.thread.join()
        self.proxy.close()


@pytest.fixture
def rig():
    near, far = free_ports(2)
    with router(near), router(far), Peer(far) as peer:
        between = Between((near, far), "uniform:50,200")
        session = open_session(
            [f"tcp/127.0.0.1:{near}"], mode="client", extra=[("timestamping/enabled", True)]
        )
        node = RosNode(
            session, Types("jazzy"), between.clock, domain=0, namespace="", name="talker", wake=lambda: None
        )
        yield node, peer, between
        session.close()
        between.close()


def test_two_ros_nodes_talk_through_the_emulator_and_the_drawn_delays_are_those_that_arrive(rig):
    node, peer, between = rig
    make, clock = node.types.make, between.clock
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
    while heard.empty():
        publisher.put(make(STRING, data="hello"))
        pause.wait(0.1)
    begin = publisher.sent
    for _ in range(COUNT):
        publisher.put(make(STRING, data="counted"))
        pause.wait(0.01)
    while len([seq for seq in arrived if seq > begin]) < COUNT:
        heard.get(timeout=PATIENCE)
    fates = [each for each in between.fates.since(0)[1] if each.key.startswith("0/chatter/")]
    drawn = {begin + 1 + n: each for n, each in enumerate(fates[-COUNT:])}
    for fate in drawn.values():
        assert fate.fate == "delivered"
    took = sorted(arrived[seq] for seq in arrived if seq > begin)
    asked = sorted(each.drawn_ns for each in drawn.values())
    assert 50e6 <= asked[0] < asked[-1] <= 200e6
    over = [got - wanted for got, wanted in zip(took, asked, strict=True)]
    assert min(over) > -1e6
    assert sorted(over)[COUNT // 2] < 20e6, over

    # A service, there and back; and what was told before.
    assert peer.call("/ask", TRIGGER).message == "heard"
    assert len(calls) == 1
    late = peer.listen("/told_before", STRING, qos=LATCHED.text)
    assert late.get(timeout=PATIENCE).data == "for who comes late"
    subscriber.undeclare()
