"""The real programs: an independent ROS 2 node drives a robot through the emulator, past an obstacle, to its target."""

import json
import math
import queue
import signal

import pytest

from farhand.common.link.ports import free_ports
from farhand.testing import Programs, short_task
from tests.farhand.bridges.ros2.peer import PATIENCE, Peer, Stream, router, twist

pytestmark = pytest.mark.realtime
TARGET = (0.5, 0.0, 0.5)
OBSTACLE = '[[obstacles]]\nid = "post"\nposition = [0.25, 0.14, 0.5]\nradius = 0.06\n'
SPEED = 0.15
TF = "tf2_msgs/msg/TFMessage"
AROUND = ((0.45, -0.35, 0.48), (0.45, 0.35, 0.48), (0.45, 0.35, 0.3), (0.45, 0.35, 0.48), (0.45, -0.05, 0.48),
          (0.45, -0.35, 0.48), (0.45, -0.35, 0.3))  # fmt: skip
"""Over the ball of `ur5-obstacle`, by each of its targets in turn (m)."""


def tool(frames, newest=False):
    """Where the tool is by the next message that says so (m)."""
    while True:
        for each in frames.get(timeout=PATIENCE).transforms:
            if each.child_frame_id == "tool" and (not newest or frames.empty()):
                at = each.transform.translation
                return at.x, at.y, at.z


def way(at, target=TARGET):
    """To the target, and how far it is (m)."""
    rest = [to - here for to, here in zip(target, at, strict=True)]
    return rest, math.dist(target, at)


def test_twists_of_an_independent_node_drive_through_the_emulator_safe_and_to_the_end(tmp_path):
    meeting, near, far, reports = free_ports(4)
    scenario = short_task(tmp_path, (TARGET,), OBSTACLE)
    results = {name: tmp_path / f"{name}.json" for name in ("robot", "operator")}
    with router(meeting), Programs(tmp_path) as programs, Peer(meeting) as peer:
        operator_side, robot_side, report = (f"tcp/127.0.0.1:{port}" for port in (near, far, reports))
        netem = programs.start("netem", "--network", "constant:200", "--listen-operator", operator_side,
                               "--listen-robot", robot_side)  # fmt: skip
        netem.wait_for("listens on")
        robot = programs.start(
            "robot", "--scenario", scenario, "--connect", robot_side, "--result", results["robot"]
        )
        operator = programs.start("operator", "--scenario", scenario, "--steer", "remote", "--connect", operator_side,
                                  "--report", report, "--result", results["operator"])  # fmt: skip
        bridge = programs.start("ros2", "--router", f"tcp/127.0.0.1:{meeting}", "--connect", report)
        frames = peer.listen("/tf", TF)
        status = peer.listen("/farhand/ur5/status", "moveit_msgs/msg/ServoStatus")
        markers = peer.listen("/farhand/ur5/markers", "visualization_msgs/msg/MarkerArray")
        start = tool(frames)
        publisher = peer.publisher("/farhand/ur5/delta_twist_cmds", "geometry_msgs/msg/TwistStamped")
        stream = Stream(lambda wanted: publisher.publish(**wanted), twist(peer))
        try:
            _drive(peer, frames, stream)
        finally:
            stream.close()
        assert way(start)[1] > 0.4
        for service in ("estop", "acknowledge"):
            asked = peer.call(f"/farhand/ur5/{service}", "std_srvs/srv/Trigger")
            assert asked.success, asked.message
        codes = set()
        while not status.empty():
            codes.add(status.get().code)
        assert 0 in codes
        assert "margin post" in {each.ns for _ in range(markers.qsize()) for each in markers.get().markers}
        for each in (bridge, operator, robot, netem):
            each.signal(signal.SIGINT)
            each.wait()
        assert bridge.process.returncode == 0
        assert json.loads(results["operator"].read_text())["finished"]
        assert json.loads(results["robot"].read_text())["min_clearance"] > 0.01


def _drive(peer, frames, stream, target=TARGET):
    """Ahead to the target; where nothing moves for a while, let go and press anew, as a person does."""
    rest, left = way(tool(frames), target)
    best, waited = left, 0
    for _ in range(20_000):
        try:
            rest, left = way(tool(frames, newest=True), target)
        except queue.Empty:
            pytest.fail("nothing is heard of the robot")
        if left < 0.015:
            stream.wanted = twist(peer)
            return
        waited = 0 if left < best - 0.002 else waited + 1
        best = min(best, left)
        held = waited % 100 >= 20 or waited == 0
        gain = min(SPEED, left) / left if held else 0.0
        stream.wanted = twist(peer, tuple(gain * each for each in rest))
    pytest.fail(f"it stands {left:.3f} m before {target}")


def test_on_the_robots_side_it_tells_the_states_and_stops_the_robot_and_is_gone_when_it_is_killed(tmp_path):
    meeting, far = free_ports(2)
    scenario = short_task(tmp_path)
    with router(meeting), Programs(tmp_path) as programs, Peer(meeting) as peer:
        robot_side = f"tcp/127.0.0.1:{far}"
        programs.start("robot", "--scenario", scenario, "--listen", robot_side)
        bridge = programs.start("ros2", "--side", "robot", "--router", f"tcp/127.0.0.1:{meeting}",
                                "--connect", robot_side)  # fmt: skip
        frames = peer.listen("/tf", TF)
        assert tool(frames) == pytest.approx((0.0, 0.0, 0.5))
        kinds = [token.split("/")[5] for token in peer.tokens() if "%farhand%ur5" in token]
        assert "MS" not in kinds
        found = peer.call("/farhand/ur5/estop", "std_srvs/srv/Trigger")
        assert found.success, found.message
        bridge.signal(signal.SIGKILL)
        bridge.wait()
        for _ in range(100):
            found = [token for token in peer.tokens() if "/SC/" not in token]  # this peer's own client stays
            left = [token for token in found if "%farhand%ur5" in token or token.endswith("/ur5")]
            if not left:
                break
        assert not left


OUT = {
    "/farhand/joint_states": "sensor_msgs/msg/JointState",
    "/tf": TF,
    "/farhand/ur5/markers": "visualization_msgs/msg/MarkerArray",
    "/farhand/ur5/status": "moveit_msgs/msg/ServoStatus",
    "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray",
    "/rosout": "rcl_interfaces/msg/Log",
    "/farhand/camera/image_raw/compressed": "sensor_msgs/msg/CompressedImage",
    "/farhand/camera/camera_info": "sensor_msgs/msg/CameraInfo",
}


@pytest.mark.long
def test_twists_drive_the_arm_of_the_demo_around_its_obstacle_and_every_topic_is_decoded(tmp_path):
    meeting, near, far, beside, reports = free_ports(5)
    results = {name: tmp_path / f"{name}.json" for name in ("robot", "operator")}
    operator_side, robot_side, report = (f"tcp/127.0.0.1:{port}" for port in (near, far, reports))
    with router(meeting), Programs(tmp_path) as programs, Peer(meeting) as peer:
        netem = programs.start("netem", "--network", "constant:200", "--listen-operator", operator_side,
                               "--listen-robot", robot_side)  # fmt: skip
        netem.wait_for("listens on")
        own = f"tcp/127.0.0.1:{beside}"
        robot = programs.start(
            "robot", "--connect", robot_side, "--listen", own, "--result", results["robot"]
        )
        operator = programs.start("operator", "--steer", "remote", "--connect", operator_side,
                                  "--report", report, "--result", results["operator"])  # fmt: skip
        camera = programs.start("camera", "--connect", own, "--connect", robot_side, "--rate", 2)
        bridge = programs.start("ros2", "--router", f"tcp/127.0.0.1:{meeting}", "--connect", report)
        heard = {topic: peer.listen(topic, kind) for topic, kind in OUT.items()}
        bridge.wait_for("node /farhand/ur5")
        tool(heard["/tf"])
        heard["/tf_static"] = peer.listen("/tf_static", TF, qos=":1:,1:,:,:,,")
        heard["/farhand/robot_description"] = peer.late("/farhand/robot_description", "std_msgs/msg/String")
        publisher = peer.publisher("/farhand/ur5/delta_twist_cmds", "geometry_msgs/msg/TwistStamped")
        stream = Stream(lambda wanted: publisher.publish(**wanted), twist(peer))
        try:
            for target in AROUND:
                _drive(peer, heard["/tf"], stream, target)
        finally:
            stream.close()
        decoded = {topic: found.get(timeout=PATIENCE) for topic, found in heard.items()}
        assert len(decoded["/farhand/joint_states"].position) == 6
        assert "<robot" in decoded["/farhand/robot_description"].data
        assert {each.child_frame_id for each in decoded["/tf_static"].transforms} >= {"base_link"}
        assert decoded["/farhand/camera/image_raw/compressed"].data[:2].tobytes() == b"\xff\xd8"
        for each in (bridge, camera, operator, robot, netem):
            each.signal(signal.SIGINT)
            each.wait()
        assert json.loads(results["operator"].read_text())["finished"]
        assert json.loads(results["robot"].read_text())["min_clearance"] > 0.01
