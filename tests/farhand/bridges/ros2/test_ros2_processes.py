"""The real `farhand ros2` between an independent ROS 2 node and a robot that it drives."""

import pytest

from farhand.common.link.ports import free_ports
from farhand.testing import Programs, short_task
from tests.farhand.bridges.ros2.peer import PATIENCE, Peer, Stream, router, twist

pytestmark = pytest.mark.realtime
TWIST = "geometry_msgs/msg/TwistStamped"


def test_twists_of_an_independent_node_drive_a_point(tmp_path):
    meeting, robot_port, report_port = free_ports(3)
    scenario = short_task(tmp_path)
    with router(meeting), Programs(tmp_path) as programs, Peer(meeting) as peer:
        robot, report = f"tcp/127.0.0.1:{robot_port}", f"tcp/127.0.0.1:{report_port}"
        programs.start("robot", "--scenario", scenario, "--listen", robot)
        programs.start("operator", "--scenario", scenario, "--steer", "remote", "--connect", robot,
                       "--report", report, "--set", "operator.rate_hz=20")  # fmt: skip
        bridge = programs.start("ros2", "--router", f"tcp/127.0.0.1:{meeting}", "--connect", report)
        bridge.wait_for("node /farhand/ur5")
        frames = peer.listen("/tf", "tf2_msgs/msg/TFMessage")
        publisher = peer.publisher("/farhand/ur5/delta_twist_cmds", TWIST)
        stream = Stream(lambda wanted: publisher.publish(**wanted), twist(peer))

        def x():
            while True:
                for each in frames.get(timeout=PATIENCE).transforms:
                    if each.child_frame_id == "tool":
                        return each.transform.translation.x

        start = x()
        stream.wanted = twist(peer, (0.2, 0.0, 0.0))
        for _ in range(2000):
            if x() > start + 0.05:
                break
        else:
            pytest.fail(f"it did not move: {bridge.said}")
        stream.close()
        assert bridge.interrupt(30) == 0
