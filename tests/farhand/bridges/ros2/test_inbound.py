"""What comes from ROS and is none is refused by its reason; CDR there and back is the same message."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from farhand.bridges.ros2.cdr.twists import TWIST, read_twist
from farhand.bridges.ros2.cdr.types import CdrError, Types
from farhand.bridges.ros2.graph.node import Heard, Subscription
from farhand.bridges.ros2.graph.wire import Attachment, data_key
from farhand.bridges.ros2.inbound.devices import JoyDevice, TwistDevice
from farhand.bridges.ros2.inbound.joy import JoySettings
from farhand.bridges.ros2.inbound.reading import (
    JOY,
    Reader,
    Refusals,
    RefusedError,
    TwistFrames,
    inputs_of,
)
from farhand.bridges.ros2.inbound.twist_hand import TwistHand
from farhand.operator_side.devices.hand import Obstacles

TYPES = Types("jazzy")
GID = b"g" * 16
MS = 1_000_000
FINITE = st.floats(-900.0, 900.0)
VECTOR = st.tuples(FINITE, FINITE, FINITE)


def key_of(kind, domain=0, topic="/farhand/r/delta_twist_cmds", type_hash=None):
    return data_key(domain, topic, kind, type_hash or TYPES.hash_of(kind))


def twist(linear=(0.0, 0.0, 0.0), angular=(0.0, 0.0, 0.0), frame="base"):
    make = TYPES.make
    vectors = [make("geometry_msgs/msg/Vector3", x=v[0], y=v[1], z=v[2]) for v in (linear, angular)]
    stamp = make("builtin_interfaces/msg/Time", sec=0, nanosec=0)
    header = make("std_msgs/msg/Header", stamp=stamp, frame_id=frame)
    return make(
        TWIST, header=header, twist=make("geometry_msgs/msg/Twist", linear=vectors[0], angular=vectors[1])
    )


def joy(axes=(0.0,) * 8, buttons=(0,) * 11):
    import numpy as np

    stamp = TYPES.make("builtin_interfaces/msg/Time", sec=0, nanosec=0)
    header = TYPES.make("std_msgs/msg/Header", stamp=stamp, frame_id="joy")
    return TYPES.make(
        JOY, header=header, axes=np.array(axes, np.float32), buttons=np.array(buttons, np.int32)
    )


class Bench:
    """A device before a topic, without a wire."""

    def __init__(self, kind=TWIST):
        self.kind, self.said, self.seq = kind, [], 0
        self.subscription = Subscription("/topic", kind)
        self.refusals = Refusals(self.said.append)
        reader = Reader(TYPES, kind, key_of(kind))
        if kind == TWIST:
            self.device = TwistDevice(
                self.subscription, reader, TwistFrames("base", "tool"), TwistHand(), self.refusals
            )
        else:
            self.device = JoyDevice(self.subscription, reader, JoySettings(), self.refusals)

    def send(self, message, now_ns, *, payload=None, key=None, attachment=b"", sent_ns=None):
        self.seq += 1
        if attachment == b"":
            attachment = Attachment(self.seq, now_ns if sent_ns is None else sent_ns, GID).to_bytes()
        payload = TYPES.encode(message, self.kind) if payload is None else payload
        self.subscription.put(Heard(key or key_of(self.kind), payload, attachment, now_ns))
        self.device.hear(now_ns)
        return self.device.wish(now_ns, Obstacles())

    @property
    def reasons(self):
        return {kind.partition(": ")[2]: count for kind, count in self.refusals.counts.items()}


WRONG = {
    "malformed": {"payload": b"\0\1\0\0\7\7"},
    "attachment": {"attachment": b"x" * 32},
    "domain": {"key": key_of(TWIST, domain=9)},
    "type": {"key": key_of("geometry_msgs/msg/Twist")},
    "type hash": {"key": key_of(TWIST, type_hash="RIHS01_" + "0" * 64)},
    "not finite": {"message": twist((math.nan, 0.0, 0.0))},
    "frame": {"message": twist((0.1, 0.0, 0.0), frame="camera")},
}


@pytest.mark.parametrize("reason", WRONG)
def test_what_is_none_is_counted_said_and_moves_nothing(reason):
    bench, wrong = Bench(), dict(WRONG[reason])
    bench.send(twist(), 0)
    wish = bench.send(wrong.pop("message", twist((0.1, 0.0, 0.0))), 10 * MS, **wrong)
    assert not wish.engaged
    assert bench.reasons == {reason: 1}
    assert len(bench.said) == 1
    assert "refused" in bench.said[0]


@pytest.mark.parametrize("reason", ["malformed", "not finite", "frame"])
def test_what_is_none_lets_go_of_what_its_sender_holds(reason):
    bench, wrong = Bench(), dict(WRONG[reason])
    bench.send(twist(), 0)
    assert bench.send(twist((0.1, 0.0, 0.0)), 10 * MS).engaged
    assert not bench.send(wrong.pop("message", twist((0.1, 0.0, 0.0))), 20 * MS, **wrong).engaged
    assert not bench.send(twist((0.1, 0.0, 0.0)), 30 * MS).engaged


@given(st.binary(max_size=200))
def test_no_bytes_make_it_throw(payload):
    bench = Bench()
    bench.send(twist(), 0)
    wish = bench.send(None, MS, payload=payload)
    assert sum(bench.refusals.counts.values()) == 1 or not wish.engaged or wish.linear


@given(VECTOR, VECTOR, st.sampled_from(("base", "tool")))
def test_twists_there_and_back(linear, angular, frame):
    message = read_twist(TYPES.encode(twist(linear, angular, frame), TWIST), TYPES)
    wanted = TwistFrames("base", "tool").wanted(message, Attachment(1, 0, GID))
    assert (wanted.linear, wanted.angular, wanted.frame) == (linear, angular, frame)


@given(st.lists(st.floats(-1.0, 1.0, width=32), max_size=12), st.lists(st.integers(0, 1), max_size=12))
def test_joysticks_there_and_back(axes, buttons):
    message = TYPES.decode(TYPES.encode(joy(axes, buttons), JOY), JOY)
    found = inputs_of(message, Attachment(1, 0, GID))
    assert [found[f"axis{n}"] for n in range(len(axes))] == axes
    assert [found[f"button{n}"] for n in range(len(buttons))] == buttons


def test_a_sequence_that_says_it_is_endless_is_refused_at_once():
    payload = TYPES.encode(joy(), JOY)
    with pytest.raises(CdrError):
        TYPES.decode(payload.replace(b"\x08\0\0\0", b"\xff\xff\xff\x7f", 1), JOY)


def test_a_joystick_drives_while_its_button_is_held_and_only_by_a_fresh_press_after_silence():
    bench, held = Bench(JOY), (0,) * 5 + (1,) + (0,) * 5
    centred, ahead = (0.0,) * 8, (0.0, 1.0) + (0.0,) * 6
    assert not bench.send(joy(centred, held), 0).engaged  # held when it came
    bench.send(joy(), 20 * MS)
    assert bench.send(joy(centred, held), 40 * MS).engaged
    wish = bench.send(joy(ahead, held), 60 * MS)
    assert wish.linear == (1.0, 0.0, 0.0)
    assert bench.device.wish(159 * MS, Obstacles()).engaged
    assert not bench.device.wish(161 * MS, Obstacles()).engaged
    for n in range(20):  # what was held up in an outage, in one burst
        assert not bench.send(joy(ahead, held), 5000 * MS + n, sent_ns=(80 + 20 * n) * MS).engaged
    assert not bench.send(joy(ahead, held), 5010 * MS).engaged
    bench.send(joy(), 5030 * MS)
    assert bench.send(joy(ahead, held), 5050 * MS).engaged
    assert bench.reasons["late"] > 10


def test_an_axis_beyond_its_end_and_a_button_that_is_none_are_refused():
    for wrong in (joy(axes=(1.5,)), joy(axes=(math.nan,)), joy(buttons=(2,))):
        with pytest.raises(RefusedError):
            inputs_of(wrong, Attachment(1, 0, GID))
