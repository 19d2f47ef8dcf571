"""Codec: every message survives the wire, as another library reads it too; whatever else comes is refused."""

import math
from collections import Counter

import msgpack
import msgspec
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from farhand.common.messages.base import SCHEMA, Echo
from farhand.common.messages.camera import CameraFrame
from farhand.common.messages.codec import MAX_PAYLOAD, Decoder, encode
from farhand.common.messages.command import VelocityCommand
from farhand.common.messages.description import RobotDescription
from farhand.common.messages.report import ControlReport
from farhand.common.messages.scene import Obstacle, Scene
from farhand.common.messages.state import RobotState
from farhand.common.messages.steering import Steering
from tests.examples import tries

REASONS = {"length", "malformed", "checksum", "schema", "unknown-field", "type", "non-finite"}
TURNING = [*map(chr, range(0x202A, 0x202F)), *map(chr, range(0x2066, 0x206A))]  # the direction of writing
KINDS = [VelocityCommand, RobotState, Scene, ControlReport, Steering, CameraFrame]

real = st.floats(-1e6, 1e6)
vector = st.tuples(real, real, real)
stamp = st.integers(0, 2**63 - 1)
printable = st.characters(exclude_categories=("Cc", "Cs", "Zl", "Zp"), exclude_characters=TURNING)
name = st.text(printable, min_size=1, max_size=64)
text = st.text(max_size=512)
echo = st.builds(Echo, stamp, stamp, stamp, st.integers(0, 2**62))
head = {"source": name, "session": stamp, "seq": stamp, "t_sent_ns": stamp, "echo": st.none() | echo}
positive = st.floats(0, 1e6, exclude_min=True)
obstacle = st.builds(Obstacle, name, vector, positive, vector)
safety = st.sampled_from(["run", "hold", "stopped", "estop"])
modes = st.sampled_from(["run", "hold", "estop", "acknowledge", "release"])
maybe = st.none() | real

commands = st.builds(
    VelocityCommand,
    **head,
    mode=modes,
    velocity=vector,
    plan=st.lists(vector, max_size=12).map(tuple),
    plan_period_ns=st.integers(1_000_000, 10_000_000_000),
    desired=vector,
    successor=stamp,
)
states = st.builds(
    RobotState,
    **head,
    t_sample_ns=stamp,
    position=vector,
    velocity=vector,
    orientation=st.tuples(real, real, real, real),
    joints=st.lists(real, max_size=16).map(tuple),
    applied_session=stamp,
    applied_seq=stamp,
    applied_for_ns=st.integers(0, 2**62),
    mode=safety,
    reason=text,
    holder=stamp,
    holder_name=st.just("") | name,
    lease_end=st.sampled_from(["", "released", "silent"]),
    waiting=st.lists(st.tuples(stamp, name), max_size=4).map(tuple),
    clearance=real,
    min_clearance=real,
    arm_clearance=maybe,
    refused=st.dictionaries(name, stamp, max_size=5),
    received=stamp,
    stops=stamp,
)
scenes = st.builds(
    Scene,
    **head,
    t_sample_ns=stamp,
    obstacles=st.lists(obstacle, max_size=5).map(tuple),
    targets=st.lists(vector, max_size=5).map(tuple),
)
positive = st.floats(1e-3, 1e6)
descriptions = st.builds(
    RobotDescription,
    **head,
    kind=name,
    model=st.just("") | name,
    joint_names=st.lists(name, max_size=7).map(tuple),
    lag=st.floats(0, 1e6),
    radius=st.floats(0, 1e6),
    rate_hz=positive,
    state_rate_hz=positive,
    max_speed=positive,
    max_age=positive,
    command_timeout=positive,
)
reports = st.builds(
    ControlReport,
    **head,
    tick=stamp,
    mode=modes,
    desired=vector,
    filtered=vector,
    intervening=st.booleans(),
    position=vector,
    predicted=vector,
    prediction_error=real,
    sigma=real,
    inflation=real,
    margin_parts=st.dictionaries(name, real, max_size=4),
    rtt=maybe,
    rtt_mean=maybe,
    rtt_std=maybe,
    loss=real,
    age=real,
    state_age=real,
    status=name,
    solve_time=real,
    binding=st.text(max_size=64),
    clearance=maybe,
    min_clearance=maybe,
    safety=st.none() | safety,
    safety_reason=text,
    stop_reason=text,
    target_index=stamp,
    target_count=stamp,
    refused_here=stamp,
    refused_there=stamp,
    stops=stamp,
    state_rate=real,
    states=stamp,
    overruns=stamp,
)
steerings = st.builds(
    Steering,
    **head,
    device=name,
    engaged=st.booleans(),
    press=stamp,
    linear=vector,
    angular=vector,
    unit=st.sampled_from(["share", "si"]),
    frame=st.sampled_from(["base", "tool", "view"]),
    view=st.tuples(real, real, real, real),
    scale=st.floats(0, 1),
    estop=st.booleans(),
    acknowledge=st.booleans(),
    take=st.booleans(),
    release=st.booleans(),
)
frames = st.builds(
    CameraFrame,
    **head,
    camera=name,
    robot_session=stamp,
    t_captured_ns=stamp,
    width=st.integers(1, 4096),
    height=st.integers(1, 4096),
    jpeg=st.binary(min_size=4, max_size=200),
)
messages = st.one_of(commands, states, scenes, descriptions, reports, steerings, frames)


def plain(message):
    """A message as the builtin types that MessagePack knows."""
    return msgspec.to_builtins(message, builtin_types=(bytes,))


def listed(value):
    """The same with lists for tuples, as another library reads them."""
    if isinstance(value, dict):
        return {k: listed(v) for k, v in value.items()}
    return [listed(v) for v in value] if isinstance(value, list | tuple) else value


@tries(60, of=200)
@given(messages)
def test_every_message_survives_the_wire(message):
    decoder = Decoder(type(message))
    assert decoder.decode(encode(message)) == message
    assert decoder.refused == Counter()


@given(messages)
def test_another_library_reads_our_bytes(message):
    found = msgpack.unpackb(encode(message))
    assert list(found)[-1] == "check"
    del found["check"]
    assert found == listed(plain(message))


@given(messages, st.booleans())
def test_we_read_the_bytes_of_another_library(message, single):
    table = plain(message)
    assert Decoder(type(message)).decode(msgpack.packb(table)) == message
    if single:  # a writer of 32-bit floats is a legal one; what it sends is rounded
        found = Decoder(type(message)).decode(msgpack.packb(table, use_single_float=True))
        assert found is None or found.seq == message.seq


@given(st.sampled_from(KINDS), st.binary(max_size=400))
def test_random_bytes_are_refused_and_counted(kind, payload):
    decoder = Decoder(kind)
    assert decoder.decode(payload) is None
    assert decoder.refused.total() == 1
    assert set(decoder.refused) <= REASONS
    assert decoder.last_refusal.startswith(next(iter(decoder.refused)))


junk = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(2**63), 2**64 - 1)
    | st.floats()
    | st.text(max_size=8)
    | st.binary(max_size=8),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(st.text(max_size=8) | st.integers(-9, 9), inner, max_size=4)
    ),
    max_leaves=12,
)


@tries(100, of=300)
@given(messages, st.data())
def test_a_message_with_one_field_of_junk_is_a_message_or_refused(message, data):
    table = plain(message)
    field = data.draw(st.sampled_from(sorted(table)))
    table[field] = data.draw(junk)
    decoder = Decoder(type(message))
    found = decoder.decode(msgpack.packb(table))
    assert (found is None) == (decoder.refused.total() == 1)
    assert set(decoder.refused) <= REASONS
    if found is not None:
        encode(found)


@given(messages, st.data())
def test_every_truncation_is_refused(message, data):
    payload = encode(message)
    cut = data.draw(st.integers(0, len(payload) - 1))
    decoder = Decoder(type(message))
    assert decoder.decode(payload[:cut]) is None
    assert set(decoder.refused) <= {"malformed", "length"}


@given(messages, st.binary(min_size=1, max_size=20))
def test_bytes_too_many_are_refused(message, tail):
    decoder = Decoder(type(message))
    assert decoder.decode(encode(message) + tail) is None
    assert decoder.refused == Counter(malformed=1)


@given(messages, st.data())
def test_every_flipped_bit_is_noticed(message, data):
    payload = bytearray(encode(message))
    bit = data.draw(st.integers(0, 8 * len(payload) - 1))
    payload[bit // 8] ^= 1 << bit % 8
    decoder = Decoder(type(message))
    assert decoder.decode(bytes(payload)) is None
    assert decoder.refused.total() == 1


@given(messages, st.sampled_from([math.nan, math.inf, -math.inf]), st.data())
def test_what_is_not_finite_is_refused_as_such(message, value, data):
    table = listed(plain(message))
    places = list(_floats(table, ()))
    assume(places)  # a scene without obstacles and targets holds no number
    *parents, last = data.draw(st.sampled_from(places))
    inner = table
    for key in parents:
        inner = inner[key]
    inner[last] = value
    decoder = Decoder(type(message))
    assert decoder.decode(msgpack.packb(table)) is None
    assert decoder.refused == Counter({"non-finite": 1})


def _floats(value, path):
    if isinstance(value, float):
        yield path
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, inner in items:
        yield from _floats(inner, (*path, key))


BASE = {
    "schema": SCHEMA,
    "source": "x",
    "session": 1,
    "seq": 1,
    "t_sent_ns": 1,
    "mode": "run",
    "velocity": [0, 0, 0],
}


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"schema": SCHEMA + 1}, "schema"),
        ({"schema": SCHEMA + 1, "colour": "red"}, "schema"),
        ({"schema": "one"}, "schema"),
        ({"colour": "red"}, "unknown-field"),
        ({"echo": {"session": 1, "seq": 1, "t_sent_ns": 1, "hold_ns": 1, "more": 1}}, "unknown-field"),
        ({"velocity": [0, 0]}, "length"),
        ({"velocity": [0, 0, 0, 0]}, "length"),
        ({"plan": [[0, 0, 0]] * 257}, "length"),
        ({"source": ""}, "length"),
        ({"source": "x" * 65}, "length"),
        ({"source": "al\x1b[2Jice"}, "type"),
        ({"source": "alice\n"}, "type"),
        ({"source": "al\u202eice"}, "type"),
        ({"successor": -1}, "type"),
        ({"mode": "walk"}, "type"),
        ({"seq": -1}, "type"),
        ({"seq": 2**63}, "type"),
        ({"seq": 1.5}, "type"),
        ({"velocity": "fast"}, "type"),
        ({"velocity": [1e7, 0, 0]}, "type"),
        ({"plan_period_ns": 0}, "type"),
        ({"check": 7}, "checksum"),
    ],
)
def test_reasons(changes, reason):
    decoder = Decoder(VelocityCommand)
    assert decoder.decode(msgpack.packb(BASE)) is not None
    assert decoder.decode(msgpack.packb(BASE | changes)) is None
    assert decoder.refused == Counter({reason: 1})


@pytest.mark.parametrize(
    ("payload", "reason"),
    [
        (b"", "length"),
        (b"\x00" * (MAX_PAYLOAD + 1), "length"),
        (msgpack.packb(BASE | {"source": "x" * MAX_PAYLOAD}), "length"),
        (b"\x91" * 500_000, "malformed"),
        (b"\x82\xa6source\x01\xa1b" + b"\x91" * 500_000, "malformed"),
        (b"\x81\x81\x01\x02\x03", "malformed"),
        (b"\x81\xa6source\xa2\xff\xfe", "malformed"),
        (b"\xc1", "malformed"),
        (b"\xdf\xff\xff\xff\xff", "malformed"),
        (b"\xdd\xff\xff\xff\xff", "malformed"),
        (msgpack.packb([1, 2]), "type"),
        (msgpack.packb(None), "type"),
        (msgpack.packb({}), "type"),
    ],
)
def test_reasons_for_raw_bytes(payload, reason):
    decoder = Decoder(VelocityCommand)
    assert decoder.decode(payload) is None
    assert decoder.refused == Counter({reason: 1})


@given(st.integers(1, 40))
def test_the_checksum_makes_room_in_a_map_of_any_size(fields):
    kind = msgspec.defstruct("Wide", [(f"f{k}", int, k) for k in range(fields)])
    found = msgpack.unpackb(encode(kind()))
    assert len(found) == fields + 1
    assert all(found[f"f{k}"] == k for k in range(fields))
