"""A hand at another program: what moves the robot, and all that does not."""

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from farhand.common.link.link import Packet
from farhand.common.messages.codec import encode
from farhand.common.messages.keys import steering_key
from farhand.common.messages.steering import Steering
from farhand.operator_side.steering.hand.latch import SILENCE_NS
from farhand.operator_side.steering.hand.remote import Remote, RemoteSettings, rotated
from farhand.operator_side.steering.hand.wheel import FREE_AFTER_NS
from farhand.testing import state, view

MS = 1_000_000
QUARTER = (math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))  # about z


class Hand:
    """A program that steers, a device that hears it, and the time."""

    def __init__(self):
        self.device, self.now, self.seq = Remote(RemoteSettings(speed=0.2, turn_speed=0.5)), 0, {}
        self.waiting, self.states = [], 0
        self.device.listen(self)

    def receive(self):
        waiting, self.waiting = self.waiting, []
        return waiting

    def says(self, session=1, seq=None, payload=None, late=0, **wish):
        self.seq[session] = self.seq.get(session, -1) + 1 if seq is None else seq
        message = Steering(
            source="console",
            session=session,
            seq=self.seq[session],
            t_sent_ns=self.now + 7 * session * MS - late * MS,
            device="console",
            **wish,
        )
        self.waiting.append(Packet(steering_key("r"), payload or encode(message), self.now))
        return self

    def after(self, ms):
        self.now += ms * MS
        return self

    def wants(self, stopping=False, **fields):
        """What it wants, the robot being so in its newest state, which is a new one."""
        self.states += 1
        return self.still_wants(stopping, **fields)

    def still_wants(self, stopping=False, **fields):
        """The same, no newer state having come."""
        seen = view(self.now, state(self.states, **fields))
        return self.device.read(replace(seen, stopping=stopping))


def pressed(**more):
    return {"engaged": True, "press": 1, "linear": (1.0, 0.0, 0.0), **more}


def test_without_any_program_it_holds():
    assert not Remote(None).read(view(0, state())).engaged


def test_a_press_moves_and_its_release_does_not():
    hand = Hand().says(**pressed())
    assert hand.wants() == hand.device.read(view(0, state()))
    assert hand.wants().velocity == (0.2, 0.0, 0.0)
    hand.after(20).says(press=1)
    assert not hand.wants().engaged
    assert hand.wants().velocity == (0.0, 0.0, 0.0)
    hand.after(20).says(**pressed())
    assert not hand.wants().engaged


def test_what_was_held_up_presses_nothing_and_still_stops():
    hand = Hand().after(1000).says(take=True).after(20).says(late=160, **pressed())
    assert not hand.wants().engaged
    hand.after(20).says(late=160, acknowledge=True)
    assert not hand.wants(mode="stopped", reason="fault").acknowledge
    hand.after(20).says(**pressed(press=1))  # it was pressed meanwhile
    assert not hand.wants().engaged
    hand.after(20).says(**pressed(press=2))
    assert hand.wants().engaged
    hand.after(20).says(late=160, **pressed(press=2))
    assert not hand.wants().engaged
    hand.after(20).says(late=500, estop=True)
    assert hand.wants().estop


def test_silence_lets_go_and_says_so():
    hand = Hand().says(**pressed())
    assert hand.after(150).wants().engaged
    assert not hand.after(1).wants().engaged
    assert "console is silent" in hand.wants().says
    assert SILENCE_NS == 150 * MS


def test_what_comes_out_of_order_is_dropped():
    hand = Hand().says(press=1, seq=7).says(seq=6, **pressed(press=2))
    assert not hand.wants().engaged


def test_what_is_no_message_is_dropped():
    hand = Hand().says(payload=b"\x80").says(payload=b"")
    assert not hand.wants().engaged


def test_one_has_the_wheel_and_a_second_one_waits_for_silence_or_release():
    hand = Hand().says(1, **pressed()).says(2, **pressed(linear=(0.0, 1.0, 0.0)))
    assert hand.wants().velocity == (0.2, 0.0, 0.0)
    hand.after(20).says(1, release=True).says(2, **pressed(press=2, linear=(0.0, 1.0, 0.0)))
    assert hand.wants().velocity == (0.0, 0.2, 0.0)
    hand.after(FREE_AFTER_NS // MS + 1).says(1, **pressed(press=5))
    assert hand.wants().velocity == (0.2, 0.0, 0.0)


def test_anyone_may_stop_it_until_the_robot_says_so_and_then_a_new_press_is_needed():
    hand = Hand().says(1, **pressed()).says(2, estop=True)
    assert hand.wants().estop
    assert hand.after(5000).says(1, **pressed()).wants().estop
    stopped = {"mode": "estop", "reason": "emergency stop"}
    assert not hand.wants(**stopped).estop
    hand.says(1, acknowledge=True)
    assert hand.wants(**stopped).acknowledge
    after = hand.after(20).says(1, **pressed()).wants()
    assert (after.acknowledge, after.estop, after.engaged) == (False, False, False)
    assert hand.after(20).says(1, **pressed(press=2)).wants().engaged


def test_an_old_stop_in_the_newest_state_does_not_swallow_a_new_one():
    hand = Hand().says(estop=True)
    assert hand.wants(mode="estop").estop
    assert hand.after(900).wants(mode="estop").estop
    assert (
        hand.after(5000).still_wants(mode="estop").estop
    )  # nothing has come since: it says nothing of this stop
    assert not hand.wants(mode="estop").estop


def test_an_emergency_stop_that_somebody_asks_for_elsewhere_ends_an_acknowledgement():
    hand = Hand().says(acknowledge=True)
    stop = {"mode": "estop", "reason": "emergency stop by operator", "stops": 1}
    assert hand.wants(**stop).acknowledge
    assert not hand.after(20).wants(stopping=True, **stop).acknowledge
    assert not hand.after(20).wants(**stop).acknowledge
    assert hand.says(acknowledge=True).wants(**stop).acknowledge


def test_another_hand_s_emergency_stop_is_swallowed_by_no_acknowledgement():
    hand = Hand().says(2, estop=True).says(1, acknowledge=True)
    wish = hand.wants(mode="stopped", stops=1)
    assert (wish.estop, wish.acknowledge) == (True, False)


def test_an_acknowledgement_counts_for_the_stop_that_was_there():
    hand = Hand().says(acknowledge=True)
    assert hand.wants(mode="stopped", stops=1).acknowledge
    assert hand.wants(mode="stopped", stops=1, holder=0).acknowledge
    assert not hand.wants(mode="stopped", stops=2).acknowledge
    assert not hand.wants(mode="stopped", stops=1).acknowledge


def test_one_given_while_the_robot_cannot_be_driven_counts_no_more_once_it_can():
    stop = {"mode": "stopped", "stops": 1}
    hand = Hand().says(acknowledge=True)
    assert hand.wants(reason="protective stop: look why", **stop).acknowledge
    assert not hand.wants(reason="ready again", **stop).acknowledge
    assert hand.says(acknowledge=True).wants(reason="ready again", **stop).acknowledge


@pytest.mark.parametrize(
    ("wish", "velocity", "angular"),
    [
        ({"linear": (1.0, 1.0, 0.0)}, (0.2 * math.sqrt(0.5), 0.2 * math.sqrt(0.5), 0.0), (0.0, 0.0, 0.0)),
        ({"linear": (0.3, 0.0, 0.0), "unit": "si", "scale": 0.5}, (0.15, 0.0, 0.0), (0.0, 0.0, 0.0)),
        ({"angular": (0.0, 0.0, -1.0)}, (0.0, 0.0, 0.0), (0.0, 0.0, -0.5)),
        ({"linear": (1.0, 0.0, 0.0), "frame": "tool"}, (0.0, 0.2, 0.0), (0.0, 0.0, 0.0)),
        (
            {"linear": (0.0, 1.0, 0.0), "frame": "view", "view": QUARTER, "angular": (1.0, 0.0, 0.0)},
            (-0.2, 0.0, 0.0),
            (0.0, 0.5, 0.0),
        ),
    ],
)
def test_six_axes_in_three_frames(wish, velocity, angular):
    wants = Hand().says(engaged=True, press=1, **wish).wants(orientation=QUARTER)
    assert wants.velocity == pytest.approx(velocity)
    assert wants.angular == pytest.approx(angular)


finite = st.floats(-10, 10)


@given(st.tuples(finite, finite, finite, finite), st.tuples(finite, finite, finite))
def test_turning_a_vector_keeps_its_length(orientation, vector):
    assert math.dist(rotated(orientation, vector), (0, 0, 0)) == pytest.approx(math.dist(vector, (0, 0, 0)))
