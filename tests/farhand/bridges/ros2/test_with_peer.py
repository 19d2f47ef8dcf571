"""The bridge and an independent node (zenoh-ros2-sdk) at a real Zenoh router, each topic both ways."""

import math
import queue
import signal
import subprocess
import sys

import numpy as np
import pytest
from msgspec.structs import replace

from farhand.bridges.ros2.graph.node import namesakes
from farhand.bridges.ros2.graph.wire import Attachment, data_key
from farhand.bridges.ros2.serving.parameters import STRING
from farhand.common.link.ports import free_ports
from farhand.common.messages.camera import CameraFrame
from farhand.testing import command, description, obstacle, report, scene, state
from tests.farhand.bridges.ros2.peer import PATIENCE, Peer, Stream, router, twist
from tests.farhand.bridges.ros2.running import running

pytestmark = pytest.mark.realtime
TWIST = "geometry_msgs/msg/TwistStamped"
TF, MARKERS = "tf2_msgs/msg/TFMessage", "visualization_msgs/msg/MarkerArray"
LATCHED = ":1:,1:,:,:,,"
NO_VALUE = {
    "bool_value": False, "integer_value": 0, "double_value": 0.0, "byte_array_value": np.zeros(0, np.uint8),
    "bool_array_value": np.zeros(0, np.bool_), "integer_array_value": np.zeros(0, np.int64),
    "double_array_value": np.zeros(0), "string_array_value": [],
}  # fmt: skip
UR5 = description(kind="ur5", model="ur5", joint_names=tuple("abcdef"), radius=0.05)


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


def first(found, holds=lambda _: True):
    """The first of a queue of which it holds."""
    while True:
        try:
            message = found.get(timeout=PATIENCE)
        except queue.Empty:
            raise AssertionError("it did not come") from None
        if holds(message):
            return message


def again(bridge, *made, every=0.1):
    """Have all of it come from Farhand ten times a second, as long as a test waits: a first one finds nobody."""
    return Stream(lambda _: [bridge.feed(*each) for each in _at(next(bridge.numbers), made)], None, every)


def _at(seq, made):
    return [each(seq) for each in made]


def drive(bridge, publish, wish, patience=1500):
    """Rest, then wish, as a hand does that presses, until it steers: a busy machine may hold something up."""
    for seq in range(patience):
        bridge.feed(report(seq, safety="run"))
        publish(None if seq % 25 < 5 else wish)
        if bridge.wait(lambda s: s.engaged, 0.02):
            return bridge.wait(lambda s: s.engaged)
    raise AssertionError(f"it does not steer: {bridge.told}")


def test_what_farhand_says_is_decoded_by_an_independent_node(bridge, peer):
    topics = {
        "/farhand/joint_states": "sensor_msgs/msg/JointState",
        "/tf": TF,
        "/farhand/r/markers": MARKERS,
        "/farhand/r/status": "moveit_msgs/msg/ServoStatus",
        "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray",
        "/rosout": "rcl_interfaces/msg/Log",
        "/farhand/camera/image_raw/compressed": "sensor_msgs/msg/CompressedImage",
        "/farhand/camera/camera_info": "sensor_msgs/msg/CameraInfo",
    }
    heard = {topic: peer.listen(topic, kind) for topic, kind in topics.items()}
    joints = (0.1, -1.0, 1.0, 0.3, 0.2, 0.1)
    picture = b"\xff\xd8\xff\xd9"
    ball = scene(0, obstacle("ball"), targets=((0.5, 0.0, 0.5),))
    moves = {"velocity": (0.1, 0.0, 0.0), "plan": ((0.1, 0.0, 0.0),) * 3}
    slowed = {"safety": "run", "states": 1, "intervening": True, "binding": "ball", "inflation": 0.03, "rtt": 0.4,
              "clearance": 0.05, "desired": (0.2, 0.0, 0.0),
              "filtered": (0.1, 0.0, 0.0), "predicted": (0.4, 0.1, 0.3)}  # fmt: skip
    stream = again(
        bridge,
        lambda seq: (UR5, "description"),
        lambda seq: (replace(ball, seq=seq), "scene"),
        lambda seq: (command(seq, **moves), "command"),
        lambda seq: (state(seq, joints=joints, position=(0.4, 0.1, 0.3)), "state"),
        lambda seq: (report(seq, **slowed),),
        lambda seq: (CameraFrame(source="r", session=1, seq=seq, t_sent_ns=0, camera="x", width=8, height=6,
                                 jpeg=picture), "camera"),
    )  # fmt: skip
    try:
        _see(heard, joints, picture)
    finally:
        stream.close()


def _see(heard, joints, picture):
    states = first(heard["/farhand/joint_states"])
    assert (list(states.name), tuple(states.position)) == (list("abcdef"), joints)
    frames = first(heard["/tf"], lambda m: any(t.child_frame_id == "tool" for t in m.transforms)).transforms
    tool = next(each for each in frames if each.child_frame_id == "tool")
    assert (tool.header.frame_id, tool.transform.translation.x) == ("base", 0.4)
    drawn = {}
    while not {"obstacle ball", "margin ball", "targets", "ghost", "plan", "binding"} <= set(drawn):
        drawn |= {each.ns: each for each in first(heard["/farhand/r/markers"]).markers if each.action == 0}
    assert drawn["obstacle ball"].scale.x == pytest.approx(0.2)
    assert len(drawn["plan"].points) == 5
    assert drawn["binding"].text == "ball: 50 mm"
    status = first(heard["/farhand/r/status"], lambda m: m.code != -1)
    assert (status.code, status.message) == (4, "slowed for ball")
    told = first(heard["/diagnostics"], lambda m: m.status[0].level == 0).status
    assert [each.name.partition(": ")[2] for each in told] == ["link", "loop", "safety", "ros2"]
    assert {each.key: each.value for each in told[0].values}["round trip (s)"] == "0.4"
    assert "the filter intervenes for ball" in first(heard["/rosout"], lambda m: "filter" in m.name).msg
    assert first(heard["/farhand/camera/image_raw/compressed"]).data.tobytes() == picture
    assert first(heard["/farhand/camera/camera_info"]).width == 8


def test_what_nobody_reads_is_not_sent(port, peer):
    with running(port, namespace="/unread") as bridge:
        told = bridge.bridge.outward
        stream = again(
            bridge, lambda seq: (UR5, "description"), lambda seq: (state(seq, joints=(0.0,) * 6), "state")
        )
        try:
            while not told.stands:
                bridge.wait(lambda s: s.engaged, 0.05)
            assert (told.joint_states.wanted, told.joint_states.sent) == (False, 0)
            first(peer.listen("/unread/joint_states", "sensor_msgs/msg/JointState"))
            assert told.joint_states.sent
        finally:
            stream.close()


def test_who_comes_late_gets_the_robot_and_its_standing_frames(bridge, peer):
    bridge.feed(UR5, "description")
    bridge.feed(state(1, joints=(0.0,) * 6), "state")
    while not bridge.bridge.outward.stands:
        bridge.wait(lambda s: s.engaged, 0.05)
    urdf = first(peer.late("/farhand/robot_description", "std_msgs/msg/String")).data
    standing = first(peer.listen("/tf_static", TF, qos=LATCHED)).transforms
    assert 'link name="urdf_base"' in urdf
    assert "file:///" in urdf
    names = {each.child_frame_id: each for each in standing}
    assert {"world", "base_link", "urdf_base"} <= set(names)
    assert names["base_link"].transform.rotation.w == 1.0
    assert abs(names["urdf_base"].transform.rotation.z) == pytest.approx(
        1.0
    )  # the UR's own, turned by half a turn


def test_twists_drive(bridge, peer):
    publisher = peer.publisher("/farhand/r/delta_twist_cmds", TWIST)
    still = twist(peer)
    steering = drive(
        bridge,
        lambda wish: publisher.publish(**(wish or still)),
        twist(peer, (0.2, 0.0, 0.0), (0.0, 0.0, 0.1), "tool", stamp=7),
    )
    assert (steering.linear, steering.angular) == ((0.2, 0.0, 0.0), (0.0, 0.0, 0.1))
    assert (steering.unit, steering.frame, steering.press, steering.device) == ("si", "tool", 1, "ROS twists")
    assert bridge.wait(lambda s: not s.engaged and s.press == 1) is not None


def test_a_joystick_drives(bridge, peer):
    publisher = peer.publisher("/joy", "sensor_msgs/msg/Joy")

    def publish(pressed):
        time = peer.make("builtin_interfaces/msg/Time", sec=0, nanosec=0)
        header = peer.make("std_msgs/msg/Header", stamp=time, frame_id="joy")
        axes = np.array([0.0, 1.0 if pressed and bridge.steered else 0.0, 0, 0, 0, 0, 0, 0], np.float32)
        buttons = np.array([0] * 5 + [int(bool(pressed))] + [0] * 5, np.int32)
        publisher.publish(header=header, axes=axes, buttons=buttons)

    steering = drive(bridge, publish, True)
    assert (steering.unit, steering.device) == ("share", "ROS joystick")
    assert "/joy: hold button5 to move" in " ".join(bridge.told)
    assert bridge.wait(lambda s: not s.engaged and s.press == 1) is not None


def test_services_answer(bridge, peer):
    trigger = "std_srvs/srv/Trigger"
    found = peer.call("/farhand/r/estop", trigger)
    assert (found.success, found.message) == (True, "stopped")
    found = peer.call("/farhand/r/acknowledge", trigger)
    assert (found.success, found.message) == (False, "nothing is stopped")
    assert bridge.desk.asked == ["estop", "acknowledge"]
    assert peer.call("/farhand/r/pause_servo", "std_srvs/srv/SetBool", data=True).success
    assert bridge.bridge.node.paused
    assert peer.call("/farhand/r/pause_servo", "std_srvs/srv/SetBool", data=False).success
    assert not bridge.bridge.node.paused
    switch = "moveit_msgs/srv/ServoCommandType"
    assert peer.call("/farhand/r/switch_command_type", switch, command_type=1).success
    assert not peer.call("/farhand/r/switch_command_type", switch, command_type=2).success


def test_it_is_in_the_graph_with_its_hashes_and_leaves_it_when_it_is_gone(port, peer):
    with running(port, domain=0) as bridge:
        mine = [token for token in peer.tokens() if f"/{bridge.zid}/" in token]
        kinds = [token.split("/")[5] for token in mine]
        assert {kind: kinds.count(kind) for kind in kinds} == {"NN": 1, "MP": 10, "MS": 2, "SS": 10}
        assert f"@ros2_lv/0/{bridge.zid}/0/0/NN/%/%farhand/r" in mine
        hashes = {token.split("/")[9]: token.split("/")[11:] for token in mine if "/MP/" in token}
        assert hashes["%farhand%joint_states"] == [
            peer.types.hash_of("sensor_msgs/msg/JointState"),
            "::,10:,:,:,,",
        ]
        assert hashes["%tf_static"] == [peer.types.hash_of(TF), LATCHED]
        bridge.kill()
        assert not [token for token in peer.tokens() if f"/{bridge.zid}/" in token]


def test_a_node_of_the_same_name_is_found_and_another_is_not(bridge, peer):
    session = peer.session.session
    assert namesakes(session, 0, "/farhand", "r") == 1
    assert [
        namesakes(session, *other) for other in ((1, "/farhand", "r"), (0, "", "r"), (0, "/farhand", "s"))
    ] == [0] * 3


def test_parameters_are_read_only(bridge, peer):
    names = peer.call("/farhand/r/list_parameters", "rcl_interfaces/srv/ListParameters", prefixes=[], depth=0)
    assert {"robot", "command_in_type", "joy.deadman"} <= set(names.result.names)
    found = peer.call(
        "/farhand/r/get_parameters", "rcl_interfaces/srv/GetParameters", names=["robot", "nonsense"]
    )
    assert [(each.type, each.string_value) for each in found.values] == [(STRING, "r"), (0, "")]
    found = peer.call(
        "/farhand/r/describe_parameters", "rcl_interfaces/srv/DescribeParameters", names=["robot"]
    )
    assert found.descriptors[0].read_only
    make = peer.types.make
    other = make("rcl_interfaces/msg/ParameterValue", **NO_VALUE | {"type": STRING, "string_value": "other"})
    wanted = [make("rcl_interfaces/msg/Parameter", name="robot", value=other)]
    found = peer.call("/farhand/r/set_parameters", "rcl_interfaces/srv/SetParameters", parameters=wanted)
    assert [(each.successful, "is read-only" in each.reason) for each in found.results] == [(False, True)]


def test_what_is_none_is_counted_said_and_moves_nothing(bridge, peer):
    topic = "/farhand/r/delta_twist_cmds"
    own, kind = peer.publisher(topic, TWIST), peer.publisher(topic, "geometry_msgs/msg/Twist")
    domain = peer.publisher(topic, TWIST, domain_id=9)
    moving = twist(peer, (0.2, 0.0, 0.0))
    key = data_key(0, topic, TWIST, peer.types.hash_of(TWIST))
    attachment, put = Attachment(1, 0, b"g" * 16).to_bytes(), peer.session.session.put

    def publish():
        kind.publish(linear=moving["twist"].linear, angular=moving["twist"].angular)
        domain.publish(**moving)
        put(key, b"\0\1\0\0\7", attachment=attachment)
        put(key, peer.types.encode(peer.make(TWIST, **moving), TWIST), attachment=attachment[:-1])
        put(key[:-1] + "x", b"", attachment=attachment)
        own.publish(**twist(peer, (math.nan, 0.0, 0.0)))
        own.publish(**twist(peer, (0.2, 0.0, 0.0), frame="camera"))

    reasons = {"type", "domain", "malformed", "attachment", "type hash", "not finite", "frame"}
    for seq in range(300):
        bridge.feed(report(seq, safety="run"))
        publish()
        if len(bridge.bridge.refusals.counts) == len(reasons):
            break
        bridge.wait(lambda s: s.engaged, 0.02)
    assert set(bridge.bridge.refusals.counts) == {f"{topic}: {reason}" for reason in reasons}
    for reason in reasons:
        assert any(f"{topic}: refused: {reason}: " in line for line in bridge.told), reason
    assert not [each for each in bridge.steered if each.engaged]


def test_a_reader_that_is_frozen_disturbs_nobody(bridge, peer, port):
    script = (
        "import sys, zenoh; from farhand.common.link.zenoh_link import open_session\n"
        f"s = open_session(['tcp/127.0.0.1:{port}'], mode='client')\n"
        "sub = s.declare_subscriber('0/**', lambda _: None); print('reads', flush=True); sys.stdin.read()"
    )
    reader = subprocess.Popen(
        [sys.executable, "-c", script], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    try:
        assert reader.stdout.readline().strip() == "reads"
        reader.send_signal(signal.SIGSTOP)
        joints = peer.listen("/farhand/joint_states", "sensor_msgs/msg/JointState")
        bridge.feed(replace(UR5, joint_names=tuple(f"joint_{n}" * 6 for n in range(6))), "description")
        stream = again(bridge, lambda seq: (state(seq, joints=(1e-6 * seq,) * 6), "state"), every=0.001)
        first(joints)
        begun = next(bridge.numbers)
        found = first(joints, lambda m: m.position[0] >= 1e-6 * (begun + 5000))  # megabytes that nobody takes
        stream.close()
        assert found.position[0] < 1e-6 * next(bridge.numbers)
        publisher, still = peer.publisher("/farhand/r/delta_twist_cmds", TWIST), twist(peer)
        wish = twist(peer, (0.2, 0.0, 0.0))
        assert drive(bridge, lambda moves: publisher.publish(**(moves or still)), wish).engaged
    finally:
        reader.kill()
        reader.communicate()
