"""Round trips, loss and age from hand-made exchanges; what arrives, kept newest by sequence number."""

import statistics

import pytest

from farhand.common.link.link import Packet
from farhand.common.messages.base import Echo
from farhand.common.messages.codec import encode
from farhand.operator_side.sensing.perception import Perception
from farhand.operator_side.sensing.round_trip import SENT, RoundTrip
from farhand.testing import scene, state

MS = 1_000_000
ME = 7


def echo(seq, sent, hold=0, session=ME):
    return Echo(session, seq, sent, hold)


def test_the_round_trip_is_now_less_the_stamp_less_the_hold():
    trip = RoundTrip(ME, 30)
    trip.received(state(0, echo=echo(0, 100 * MS, hold=5 * MS)), 147 * MS)
    assert trip.newest == pytest.approx(0.042)
    assert trip.mean == pytest.approx(0.042)
    assert trip.std == 0.0
    assert trip.overall() == (pytest.approx(0.042), 0.0)


def test_only_the_first_echo_of_a_command_counts():
    trip = RoundTrip(ME, 30)
    trip.received(state(0, echo=echo(3, 0)), 10 * MS)
    trip.received(state(1, echo=echo(3, 0, hold=1 * MS)), 90 * MS)  # says nothing new
    trip.received(state(2, echo=echo(2, 0)), 95 * MS)  # came too late
    trip.received(state(3, echo=echo(9, 0, session=8)), 99 * MS)  # not mine
    trip.received(state(4), 99 * MS)
    assert (trip.count, trip.newest) == (1, pytest.approx(0.010))
    trip.received(state(5, echo=echo(5, 50 * MS)), 70 * MS)
    assert (trip.count, trip.newest) == (2, pytest.approx(0.020))


def test_mean_and_standard_deviation_over_the_window_and_over_all():
    trip, samples = RoundTrip(ME, 4), [0.010, 0.030, 0.020, 0.050, 0.040, 0.090]
    for seq, rtt in enumerate(samples):
        trip.received(state(seq, echo=echo(seq, 0)), round(rtt * 1e9))
    assert trip.mean == pytest.approx(statistics.mean(samples[-4:]))
    assert trip.std == pytest.approx(statistics.stdev(samples[-4:]))
    assert trip.overall() == (
        pytest.approx(statistics.mean(samples)),
        pytest.approx(statistics.stdev(samples)),
    )


def test_nothing_measured():
    trip = RoundTrip(ME, 30)
    assert (trip.mean, trip.std, trip.newest, trip.loss, trip.age(5)) == (0.0, 0.0, None, None, 0.0)
    assert trip.overall() == (None, None)


def test_a_clock_that_cannot_be_gives_no_negative_round_trip():
    trip = RoundTrip(ME, 30)
    trip.received(state(0, echo=echo(0, 100 * MS, hold=50 * MS)), 110 * MS)
    assert trip.newest == 0.0


def test_age_is_that_of_the_oldest_unanswered_command():
    trip = RoundTrip(ME, 30)
    for seq in range(5):
        trip.sent(seq, seq * 100 * MS)
    assert trip.age(450 * MS) == pytest.approx(0.450)
    trip.received(state(0, echo=echo(2, 200 * MS)), 300 * MS)
    assert trip.age(450 * MS) == pytest.approx(0.150)
    trip.received(state(1, echo=echo(4, 400 * MS)), 430 * MS)
    assert trip.age(450 * MS) == 0.0


def test_age_stays_true_however_long_nothing_is_answered():
    trip = RoundTrip(ME, 30)
    for seq in range(2 * SENT):
        trip.sent(seq, seq * 20 * MS)
    assert trip.age(2 * SENT * 20 * MS) == pytest.approx(2 * SENT * 0.02)
    trip.received(state(0, echo=echo(2 * SENT - 1, 0)), 0)
    assert trip.age(2 * SENT * 20 * MS) == 0.0


def test_perception_keeps_the_newest_by_sequence_number():
    perception = Perception("r")
    assert (perception.state, perception.scene) == (None, None)
    for arrived, seq in ((10, 4), (20, 6), (30, 5)):
        got = perception.take(Packet("farhand/r/state", encode(state(seq)), arrived))
        assert got.seq == seq  # a late one is told of, for the round trip and the loss
    assert perception.state.seq == 6
    assert perception.newest_state.arrived_ns == 20
    for seq in (2, 1):
        assert perception.take(Packet("farhand/r/scene", encode(scene(seq)), 5)) is None
    assert perception.scene.seq == 2


def test_perception_counts_what_it_refuses_and_ignores_foreign_keys():
    perception = Perception("r")
    for key, payload in (
        ("farhand/r/state", b"junk"),
        ("farhand/r/scene", b""),
        ("farhand/r/state", encode(scene(1))),
        ("farhand/other/state", encode(state(1))),
        ("farhand/r/command", b"junk"),
    ):
        assert perception.take(Packet(key, payload, 1)) is None
    assert perception.refused == 3
    assert perception.state is None


def test_state_rate():
    perception = Perception("r")
    assert perception.state_rate(100) == 0.0
    for k in range(60):
        perception.take(Packet("farhand/r/state", encode(state(k)), k * 10 * MS))
    assert perception.state_rate(600 * MS) == pytest.approx(100.0, rel=0.03)
    assert perception.state_rate(5_600 * MS) == pytest.approx(9.1, rel=0.03)
