"""What is written by hand, because it is told often, is byte for byte what the library for all types writes."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from farhand.bridges.ros2.cdr.frames import FRAMES, Frames
from farhand.bridges.ros2.cdr.joint_states import JOINT_STATE, JointStates
from farhand.bridges.ros2.cdr.marker_array import ARRAY, Marker, encode_markers
from farhand.bridges.ros2.cdr.twists import TWIST, StampedTwist, read_twist
from farhand.bridges.ros2.cdr.types import CdrError, Types
from farhand.exports.ros_messages import Ros
from farhand.testing import state

TYPES = Types("jazzy")
ROS = Ros(TYPES.types)
INSTANTS = st.integers(0, 2**31 * 10**9 - 1)
FINITE = st.floats(-900.0, 900.0)
VECTOR = st.tuples(FINITE, FINITE, FINITE)
FOUR = st.tuples(FINITE, FINITE, FINITE, FINITE)
NAMES = st.text(max_size=12).filter(lambda text: "\0" not in text and text.isprintable())
SHARE = st.floats(0.0, 1.0, width=32)
MARKERS = st.builds(
    Marker,
    group=NAMES,
    number=st.integers(0, 99),
    kind=st.integers(0, 11),
    position=VECTOR,
    orientation=FOUR,
    scale=VECTOR,
    color=st.tuples(SHARE, SHARE, SHARE, SHARE),
    points=st.lists(VECTOR, max_size=4).map(tuple),
    text=NAMES,
    action=st.integers(0, 3),
)


@given(INSTANTS, st.lists(FINITE, min_size=1, max_size=16))
def test_joint_states(time_ns, positions):
    names = [f"joint_{n}" for n in range(len(positions))]
    found = JointStates(TYPES, ROS, names).encode(time_ns, positions)
    assert found == TYPES.encode(ROS.joints(time_ns, names, state(joints=tuple(positions))), JOINT_STATE)


@given(st.lists(INSTANTS, min_size=1, max_size=2), st.lists(st.tuples(NAMES, VECTOR, FOUR), max_size=5))
def test_frames(instants, frames):
    layout = Frames("base", [name for name, _, _ in frames])
    for time_ns in instants:  # nothing of the message before is left
        assert layout.encode(time_ns, frames) == TYPES.encode(ROS.frames(time_ns, frames), FRAMES)


@given(INSTANTS, NAMES, st.integers(0, 9), st.lists(MARKERS, max_size=4))
def test_markers(time_ns, frame, lifetime, markers):
    found = encode_markers(time_ns, frame, lifetime, markers)
    made = [_made(each, ROS.header(time_ns, frame), lifetime) for each in markers]
    assert found == TYPES.encode(ROS.make(ARRAY, markers=made), ARRAY)


@given(
    st.text(max_size=12),
    VECTOR,
    VECTOR,
    st.booleans(),
    st.lists(st.tuples(st.integers(0, 90), st.integers(0, 255)), max_size=2),
)
def test_twists_whatever_befalls_their_bytes(frame, linear, angular, little, changes):
    message = ROS.make(
        TWIST,
        header=ROS.header(7, frame),
        twist=ROS.make("geometry_msgs/msg/Twist", linear=ROS.vector(linear), angular=ROS.vector(angular)),
    )
    payload = bytearray(TYPES._store.serialize_cdr(message, TWIST, little_endian=little))
    for at, value in changes:
        payload[at : at + 1] = bytes([value])
    made = outcome(lambda: _of_library(TYPES.decode(bytes(payload), TWIST)))
    assert repr(outcome(lambda: read_twist(bytes(payload), TYPES))) == repr(made)


def outcome(read):
    try:
        return read()
    except CdrError:
        return "refused"


def _of_library(message):
    parts = message.twist.linear, message.twist.angular
    return StampedTwist(message.header.frame_id, *((v.x, v.y, v.z) for v in parts))


def _made(marker, header, lifetime):
    none, (r, g, b, a) = np.array([], dtype=np.uint8), marker.color
    return ROS.make(
        "visualization_msgs/msg/Marker",
        header=header,
        ns=marker.group,
        id=marker.number,
        type=marker.kind,
        action=marker.action,
        pose=ROS.pose(marker.position, marker.orientation),
        scale=ROS.vector(marker.scale),
        color=ROS.make("std_msgs/msg/ColorRGBA", r=r, g=g, b=b, a=a),
        lifetime=ROS.make("builtin_interfaces/msg/Duration", sec=lifetime, nanosec=0),
        frame_locked=False,
        points=[ROS.make("geometry_msgs/msg/Point", x=x, y=y, z=z) for x, y, z in marker.points],
        colors=[],
        texture_resource="",
        texture=ROS.make("sensor_msgs/msg/CompressedImage", header=header, format="", data=none),
        uv_coordinates=[],
        text=marker.text,
        mesh_resource="",
        mesh_file=ROS.make("visualization_msgs/msg/MeshFile", filename="", data=none),
        mesh_use_embedded_materials=False,
    )
