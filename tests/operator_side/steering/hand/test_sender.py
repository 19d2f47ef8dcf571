"""What leaves a program with a hand before it: presses at once, letting go once, and the wheel kept meanwhile."""

from farhand.common.link.link import memory_wire
from farhand.common.messages.codec import Decoder
from farhand.common.messages.keys import steering_key
from farhand.common.messages.steering import Steering, unsent
from farhand.operator_side.steering.hand.sender import IDLE_NS, SteeringSender

HELD = unsent(engaged=True, press=1, linear=(1.0, 0.0, 0.0))


class Hand:
    def __init__(self):
        near, self.far = memory_wire()
        self.sender = SteeringSender("r", near, 7, "pad", "a gamepad")
        self.now_ns, self.decoder = 0, Decoder(Steering)

    def tells(self, wish, after_ns=20_000_000, keeps=True):
        self.now_ns += after_ns
        self.sender.send(wish, self.now_ns, drives=keeps)
        found = self.far.receive()
        assert all(packet.key == steering_key("r") for packet in found)
        return [self.decoder.decode(packet.payload) for packet in found]


def test_what_is_held_is_told_at_every_call_and_letting_go_once():
    hand = Hand()
    first, second = hand.tells(HELD) + hand.tells(HELD)
    assert (first.session, first.seq, second.seq) == (7, 0, 1)
    assert (first.linear, first.press, first.device) == ((1.0, 0.0, 0.0), 1, "a gamepad")
    assert second.t_sent_ns == hand.now_ns
    (gone,) = hand.tells(unsent(press=1))
    assert not gone.engaged
    assert hand.tells(unsent(press=1)) == []


def test_the_wheel_is_kept_by_who_wants_it():
    hand = Hand()
    hand.tells(HELD)
    hand.tells(unsent())
    assert len(hand.tells(unsent(), IDLE_NS + 1)) == 1
    assert hand.tells(unsent(), IDLE_NS + 1, keeps=False) == []
