import pytest

from farhand.common.link.link import Packet
from farhand.common.messages.codec import CodecError, encode
from farhand.testing import ScriptedLink, command, scene, state

MS = 1_000_000


def test_what_is_fed_arrives_when_it_is_due():
    link = ScriptedLink("r1")
    link.feed(state(2), at_ns=20 * MS)
    link.feed(state(1), at_ns=10 * MS)
    link.feed(scene(1), at_ns=10 * MS)
    assert link.receive() == []
    link.now_ns = 10 * MS
    assert [(p.key, p.arrived_ns) for p in link.receive()] == [
        ("farhand/r1/state", 10 * MS),
        ("farhand/r1/scene", 10 * MS),
    ]
    link.now_ns = 30 * MS
    (late,) = link.receive()
    assert (late.payload, late.arrived_ns) == (encode(state(2)), 20 * MS)
    link.feed(command(1))
    (now,) = link.receive()
    assert (now.key, now.arrived_ns) == ("farhand/r1/command", 30 * MS)
    assert link.receive() == []


def test_bytes_come_as_they_are_under_the_key_that_is_said():
    link = ScriptedLink()
    link.feed(b"junk", key="farhand/elsewhere/state")
    link.feed(state(), key="farhand/elsewhere/state")
    assert [p.payload for p in link.receive()] == [b"junk", encode(state())]
    with pytest.raises(ValueError, match="which key"):
        link.feed(b"junk")


def test_what_is_sent_is_kept_and_taken_once():
    link = ScriptedLink()
    for message, key in ((command(1), "farhand/r/command"), (state(1), "farhand/r/state")):
        link.send(Packet(key, encode(message)))
    assert link.take() == [command(1), state(1)]
    assert link.take() == []
    link.send(Packet("farhand/r/state", encode(state(2))))
    link.send(Packet("farhand/r/command", encode(command(2))))
    assert link.take("command") == [command(2)]
    assert link.take("command") == []
    assert link.take("state") == [state(2)]
    assert [packet.key for packet in link.sent] == [
        f"farhand/r/{kind}" for kind in ("command", "state", "state", "command")
    ]


def test_what_no_receiver_would_accept_is_told():
    link = ScriptedLink()
    link.send(Packet("farhand/r/command", b"junk"))
    with pytest.raises(CodecError, match="malformed"):
        link.take()


def test_whoever_sends_may_be_answered():
    link = ScriptedLink(on_send=lambda packet: link.feed(state(7)))
    link.send(Packet("farhand/r/command", encode(command(1))))
    assert [p.payload for p in link.receive()] == [encode(state(7))]
