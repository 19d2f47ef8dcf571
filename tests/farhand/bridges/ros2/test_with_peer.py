"""The bridge and an independent node (zenoh-ros2-sdk) at a real Zenoh router, each topic both ways."""

import pytest

from farhand.common.link.ports import free_ports
from farhand.testing import description, report, state
from tests.farhand.bridges.ros2.peer import PATIENCE, Peer, router, twist
from tests.farhand.bridges.ros2.running import running

pytestmark = pytest.mark.realtime
TWIST = "geometry_msgs/msg/TwistStamped"


@pytest.fixture(scope="module")
def port():
    (found,) = free_ports(1)
    with router(found):
        yield found


@pytest.fixture(scope="module")
def peer(port):
    with Peer(port) as found:
        yield found


@pytest.fixture
def bridge(port):
    with running(port) as found:
        yield found


def test_joint_states_arrive_and_twists_drive(bridge, peer):
    joints = peer.listen("/farhand/joint_states", "sensor_msgs/msg/JointState")
    publisher = peer.publisher("/farhand/r/delta_twist_cmds", TWIST)
    bridge.feed(description(joint_names=("a", "b")), "description")
    bridge.feed(state(1, joints=(0.5, -1.0)), "state")
    found = joints.get(timeout=PATIENCE)
    assert list(found.position) == [0.5, -1.0]
    for seq in range(200):
        bridge.feed(report(seq, safety="run"))
        publisher.publish(**twist(peer, (0.0, 0.0, 0.0) if seq < 3 else (0.2, 0.0, 0.1), frame="tool"))
        if bridge.wait(lambda s: s.engaged, 0.02):
            break
    steering = bridge.wait(lambda s: s.engaged)
    assert (steering.linear, steering.unit, steering.frame, steering.press) == (
        (0.2, 0.0, 0.1),
        "si",
        "tool",
        1,
    )
    assert bridge.wait(lambda s: not s.engaged) is not None
