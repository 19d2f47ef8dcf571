"""Hold-to-run by arrival: whatever a stream of twists does, nothing moves but what is fresh, in order and held."""

from hypothesis import given
from hypothesis import strategies as st

from farhand.bridges.ros2.inbound.arrivals import LATE_NS
from farhand.bridges.ros2.inbound.twist_hand import SILENCE_NS, TwistHand, Wanted
from farhand.bridges.ros2.settings import UNITS

REST, FORWARD = Wanted((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)), Wanted((0.1, 0.0, 0.0), (0.0, 0.0, 0.0))
A, B = b"a" * 16, b"b" * 16
MS = 1_000_000


class Sender:
    """Sends over a line that takes a while, with a clock of its own."""

    def __init__(self, hand, gid=A, clock_ns=-(10**18)):
        self.hand, self.gid, self.clock_ns, self.seq = hand, gid, clock_ns, 0

    def send(self, wanted, sent_ns, arrives_ns=None):
        self.seq += 1
        arrives_ns = sent_ns + MS if arrives_ns is None else arrives_ns
        return self.hand.hear(self.gid, self.seq, sent_ns + self.clock_ns, wanted, arrives_ns)


def driving():
    hand = TwistHand()
    sender = Sender(hand)
    sender.send(REST, 0)
    sender.send(FORWARD, 10 * MS)
    return hand, sender


def test_a_zero_and_then_a_twist_is_a_press_and_silence_lets_go():
    hand, sender = driving()
    wish = hand.wish(11 * MS)
    assert (wish.engaged, wish.press, wish.linear, wish.unit) == (True, 1, (0.1, 0.0, 0.0), "si")
    assert hand.wish(11 * MS + SILENCE_NS).engaged
    assert not hand.wish(12 * MS + SILENCE_NS).engaged
    assert sender.send(FORWARD, 300 * MS) == "not zero before"
    assert not hand.wish(301 * MS).engaged
    sender.send(REST, 310 * MS)
    sender.send(FORWARD, 320 * MS)
    assert hand.wish(321 * MS).press == 2


def test_without_units_a_twist_is_a_share():
    hand = TwistHand(UNITS["unitless"])
    sender = Sender(hand)
    sender.send(REST, 0)
    sender.send(FORWARD, 10 * MS)
    assert (hand.wish(11 * MS).engaged, hand.wish(11 * MS).unit) == (True, "share")


def test_what_is_held_before_it_comes_moves_nothing():
    hand = TwistHand()
    sender = Sender(hand)
    assert sender.send(FORWARD, 0) == "not zero before"
    assert not hand.wish(MS).engaged


def test_a_burst_of_old_twists_moves_nothing_even_with_a_release_and_a_press_in_it():
    hand, sender = driving()
    held_up = [FORWARD] * 50 + [REST] * 5 + [FORWARD] * 50
    arrives = 10_000 * MS
    for n, wanted in enumerate(held_up):  # sent in the first two seconds of an outage of ten
        sender.send(wanted, (20 + 20 * n) * MS, arrives + n)
        assert not hand.wish(arrives + n).engaged
    sender.send(FORWARD, arrives + 5 * MS)
    assert not hand.wish(arrives + 6 * MS).engaged
    sender.send(REST, arrives + 10 * MS)
    sender.send(FORWARD, arrives + 20 * MS)
    assert hand.wish(arrives + 21 * MS).engaged


def test_another_sender_does_not_take_the_wheel_and_a_newer_twist_is_not_undone_by_an_older():
    hand, sender = driving()
    other = Sender(hand, B)
    other.send(REST, 11 * MS)
    assert other.send(FORWARD, 12 * MS) == "another sender drives"
    assert hand.hear(A, 1, sender.clock_ns, REST, 20 * MS) == "overtaken"
    assert hand.wish(20 * MS).engaged


def test_a_clock_that_was_set_back_is_believed_again():
    hand = TwistHand()
    sender = Sender(hand)
    sender.send(REST, 0)
    sender.clock_ns -= 500 * MS
    now = 0
    while sender.send(REST, now):
        now += 50 * MS
    assert 30e9 < now < 60e9
    sender.send(FORWARD, now + 50 * MS)
    assert hand.wish(now + 51 * MS).engaged


def test_what_is_none_lets_go_of_its_sender():
    hand, _ = driving()
    hand.refuse(B)
    assert hand.wish(12 * MS).engaged
    hand.refuse(A)
    assert not hand.wish(12 * MS).engaged


EVENTS = st.lists(
    st.tuples(
        st.sampled_from((A, B)),
        st.booleans(),
        st.integers(0, 250),  # ms until it is sent
        st.integers(0, 400),  # ms under way
    ),
    max_size=40,
)


@given(EVENTS, st.integers(-(10**18), 10**18))
def test_nothing_moves_but_what_is_fresh_and_held(events, clock_ns):
    """Against the truth, which no clock of the hand knows: when each twist was sent, and how long it took."""
    hand, sent_ns, arriving = TwistHand(), 0, []
    for number, (gid, rests, wait, way) in enumerate(events):
        sent_ns += wait * MS
        arriving.append((sent_ns + way * MS, number, gid, REST if rests else FORWARD, sent_ns))
    heard, fastest = [], {}
    for arrived_ns, number, gid, wanted, sent_ns in sorted(arriving, key=lambda each: each[:2]):
        before = hand.wish(arrived_ns).engaged
        assert not before or arrived_ns - heard[-1][0] <= SILENCE_NS
        why = hand.hear(gid, number, sent_ns + clock_ns, wanted, arrived_ns)
        fastest[gid] = min(arrived_ns - sent_ns, fastest.get(gid, arrived_ns - sent_ns))
        if not why:
            heard.append((arrived_ns, gid, wanted, sent_ns))
        if hand.wish(arrived_ns).engaged:
            moves = [each for each in heard if each[2] is FORWARD]
            at_ns, driver, _, its_ns = moves[-1]
            assert arrived_ns - at_ns <= SILENCE_NS
            assert at_ns - its_ns <= fastest[driver] + LATE_NS + 0.01 * at_ns
            rests = [each for each in heard if each[1] == driver and each[2] is REST]
            assert rests, "it moved without a zero before"
