"""The bridge's loop in virtual time: what lets go of a stream of twists that goes on all the while."""

import pytest

from farhand.bridges.ros2.bridge_node import BridgeNode
from farhand.bridges.ros2.cdr.twists import TWIST
from farhand.bridges.ros2.graph.node import Heard, Subscription
from farhand.bridges.ros2.graph.wire import Attachment
from farhand.bridges.ros2.inbound.devices import TwistDevice
from farhand.bridges.ros2.inbound.reading import Reader, Refusals, TwistFrames
from farhand.bridges.ros2.inbound.twist_hand import TwistHand
from farhand.common.link.link import Packet
from farhand.common.messages.codec import Decoder, encode
from farhand.common.messages.keys import report_key, steering_key
from farhand.common.messages.steering import Steering
from farhand.operator_side.steering.hand.sender import SteeringSender
from farhand.operator_side.supervision import NOT_ENGAGED
from farhand.testing import ScriptedLink, report
from tests.farhand.bridges.ros2.test_inbound import GID, TYPES, key_of, twist

MS = 1_000_000
FORWARD = twist((0.1, 0.0, 0.0))


class Drive:
    """Twists at 100 Hz, reports at 20 Hz."""

    def __init__(self):
        self.link, self.now_ns, self.seq, self.passed = ScriptedLink("r"), 0, 0, []
        self.subscription = Subscription("/topic", TWIST)
        device = TwistDevice(self.subscription, Reader(TYPES, TWIST, key_of(TWIST)), TwistFrames("base", "tool"),
                             TwistHand(), Refusals(lambda _: None))  # fmt: skip
        seats = [(device, SteeringSender("r", self.link, 1, "ros2", "ROS twists"))]
        self.node = BridgeNode(self.link, seats, lambda packet, _: self.passed.append(packet.key))
        self._decoder = Decoder(Steering)

    def run(self, message, times, **fields):
        """The same twist and report for a while; what was said last."""
        for _ in range(times):
            self.seq += 1
            self.now_ns += 10 * MS
            self.link.now_ns = self.now_ns
            if self.seq % 5 == 0 and fields.get("reports", True):
                told = {"safety": "run"} | {key: value for key, value in fields.items() if key != "reports"}
                self.link.feed(report(self.seq, **told), self.now_ns)
            attachment = Attachment(self.seq, self.now_ns, GID).to_bytes()
            self.subscription.put(Heard(key_of(TWIST), TYPES.encode(message, TWIST), attachment, self.now_ns))
            self.node.step(self.now_ns)
        return self.said()

    def said(self):
        """The last that was sent to the operator's program."""
        said = [
            self._decoder.decode(each.payload) for each in self.link.sent if each.key == steering_key("r")
        ]
        return said[-1] if said else None


@pytest.fixture
def drive():
    found = Drive()
    found.run(twist(), 10)
    assert found.run(FORWARD, 10).engaged
    return found


@pytest.mark.parametrize(
    ("what", "fields"),
    [
        ("paused", {}),
        ("stopped", {"safety": "stopped"}),
        ("estop", {"safety": "estop"}),
        ("robot silent", {"state_age": 1.5}),
        ("operator silent", {"reports": False}),
        ("not taken", {"stop_reason": NOT_ENGAGED}),
    ],
)
def test_what_lets_go_wants_a_fresh_press_afterwards(drive, what, fields):
    drive.node.paused = what == "paused"
    assert not drive.run(FORWARD, 150, **fields).engaged
    drive.node.paused = False
    assert not drive.run(FORWARD, 50).engaged
    drive.run(twist(), 5)
    steering = drive.run(FORWARD, 5)
    assert (steering.engaged, steering.press) == (True, 2)


def test_silence_lets_go_at_once_though_nothing_comes_that_would_wake_it(drive):
    heard_ns = now_ns = drive.now_ns
    while drive.said().engaged:
        due_ns = drive.node.step(now_ns)
        if drive.said().engaged:
            now_ns = drive.link.now_ns = due_ns
    assert now_ns == heard_ns + 100 * MS + 1


def test_reports_are_handed_on_and_the_wheel_is_given_up_at_the_end(drive):
    assert set(drive.passed) == {report_key("r")}
    drive.node.leave(drive.now_ns)
    assert drive.run(twist(), 0).release


def test_a_packet_that_is_no_report_changes_nothing(drive):
    before = drive.node.hearing.report
    drive.link.now_ns = drive.now_ns
    drive.link.receive()
    drive.node.hearing.take(Packet(report_key("r"), encode(report(1))[:-5], drive.now_ns))
    assert drive.node.hearing.report is before
