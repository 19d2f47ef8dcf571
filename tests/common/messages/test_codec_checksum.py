"""The check that a message carries: any flipped bit is noticed, and nodes never see the field."""

import msgpack
import msgspec
import pytest

from farhand.common.messages.base import Echo
from farhand.common.messages.codec import CodecError, Decoder, encode
from farhand.common.messages.command import VelocityCommand
from farhand.common.messages.scene import Scene
from farhand.testing import command, scene, state

COMMAND = command(9, velocity=(0.1, 0.2, 0.3), echo=Echo(1, 2, 3, 4))
STATE, SCENE = state(9), scene(9)


@pytest.mark.parametrize("message", [COMMAND, STATE, SCENE], ids=["fixmap", "map 16", "scene"])
def test_any_flipped_bit_is_noticed(message):
    payload = encode(message)
    decoder = Decoder(type(message))
    assert decoder.decode(payload) == message
    for bit in range(8 * len(payload)):
        flipped = bytearray(payload)
        flipped[bit // 8] ^= 1 << bit % 8
        assert decoder.decode(bytes(flipped)) is None, bit
    assert decoder.refused["checksum"] > 0


def test_another_library_reads_the_check_and_may_leave_it_out():
    found = msgpack.unpackb(encode(COMMAND))
    assert list(found)[-1] == "check"
    del found["check"]
    assert Decoder(VelocityCommand).decode(msgpack.packb(found)) == COMMAND


def test_a_check_that_is_not_the_last_field_is_refused():
    found = msgpack.unpackb(encode(COMMAND))
    moved = {"check": found.pop("check"), **found}
    with pytest.raises(CodecError, match="checksum"):
        Decoder(VelocityCommand).decode_or_raise(msgpack.packb(moved))


def test_nodes_do_not_see_it():
    assert Decoder(Scene).decode(encode(SCENE)).check is msgspec.UNSET
