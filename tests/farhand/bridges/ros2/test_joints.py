"""Joints that are read without the rest of their state are those of the state, and of what is none nothing is."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from farhand.bridges.ros2.outbound.joints import JointReader, Joints
from farhand.common.messages.codec import Decoder, encode
from farhand.common.messages.state import RobotState
from farhand.testing import state

JOINTS = st.lists(st.floats(-900.0, 900.0), max_size=16).map(tuple)


@given(JOINTS, st.integers(0, 1 << 30))
def test_of_what_its_sender_sealed_only_they_are_read(joints, seq):
    reader = JointReader()
    found = reader.read(encode(state(seq, joints=joints)))
    assert isinstance(found, Joints)
    assert (found.joints, found.seq, found.session) == (joints, seq, state(seq).session)


@given(JOINTS, st.lists(st.tuples(st.integers(0, 999), st.integers(0, 255)), min_size=1, max_size=2))
def test_bytes_that_were_changed_are_what_a_whole_state_makes_of_them(joints, changes):
    payload = bytearray(encode(state(5, joints=joints)))
    for at, value in changes:
        payload[at % len(payload)] = value
    reader, whole = JointReader(), Decoder(RobotState)
    found, expected = reader.read(bytes(payload)), whole.decode(bytes(payload))
    assert (found and found.joints) == (expected and expected.joints)
    assert reader.whole.refused == whole.refused


@pytest.mark.parametrize("wrong", [{"joints": (math.nan,)}, {"joints": (1e9,)}, {"schema": 3}])
def test_a_seal_makes_no_state_of_what_is_none(wrong):
    reader = JointReader()
    assert reader.read(encode(state(1, **({"joints": (0.0,)} | wrong)))) is None
    assert sum(reader.whole.refused.values()) == 1
