"""The robot's own speed against what was sent: in time it follows, after that it is said that it does not."""

import pytest

from farhand.operator_side.console.following import STARTS_S, Following
from farhand.testing import report, state

S, TICK_NS = 1_000_000_000, 20_000_000
TRIP_S, FULL = 0.4, (0.15, 0.0, 0.0)
EXPLAINED_NS = round((STARTS_S + TRIP_S) * S)


def drive(until_ns, sent, measured, **more):
    """What is missing at each instant of a drive, by time."""
    following, found = Following(), {}
    for now in range(0, until_ns, TICK_NS):
        told = report(filtered=sent(now), rtt_mean=TRIP_S, **more)
        found[now] = following.note(told, state(velocity=measured(now)), 0.0, now)
    return found


def test_a_robot_that_stands_is_on_the_way_first_and_does_not_follow_after():
    found = drive(2 * S, lambda _: FULL, lambda _: (0.0, 0.0, 0.0))
    for now, short in found.items():
        assert short.stands
        assert short.lasting is (now >= EXPLAINED_NS)


def test_a_robot_that_follows_a_round_trip_later_lacks_nothing():
    late = round(TRIP_S * S)
    found = drive(2 * S, lambda _: FULL, lambda now: FULL if now >= late else (0.0, 0.0, 0.0))
    assert not any(short and short.lasting for short in found.values())
    assert not any(short for now, short in found.items() if now >= late)


def test_a_hand_that_turns_round_again_and_again_is_followed_late_and_never_stands():
    def sent(now):
        return FULL if now // S % 2 == 0 else (-0.15, 0.0, 0.0)

    late = round(TRIP_S * S)
    found = drive(6 * S, sent, lambda now: sent(now - late) if now >= late else (0.0, 0.0, 0.0))
    assert any(found.values())
    assert not any(short and short.lasting for short in found.values())


def test_only_a_robot_that_does_nothing_for_good_is_said_not_to_follow():
    for speed, unfollowed in ((0.0, True), (0.01, True), (0.1, False), (0.15, False)):
        short = list(drive(2 * S, lambda _: FULL, lambda _, v=speed: (v, 0.0, 0.0)).values())[-1]
        assert (short is not None and short.unfollowed) is unfollowed
    assert not drive(2 * S, lambda _: FULL, lambda _: (0.0, 0.0, 0.0))[0].unfollowed


@pytest.mark.parametrize("measured", [(0.03, 0.0, 0.0), (0.0, 0.15, 0.0), (-0.15, 0.0, 0.0)])
def test_a_crawl_another_way_and_the_way_back_are_no_following(measured):
    short = list(drive(2 * S, lambda _: FULL, lambda _: measured).values())[-1]
    assert short.lasting
    assert short.done <= 0.03


def test_a_turn_that_is_not_made_is_missed_too():
    short = list(
        drive(2 * S, lambda _: (0.0, 0.0, 0.0), lambda _: (0.0, 0.0, 0.0), angular=(0.0, 0.0, 0.5)).values()
    )[-1]
    assert (short.unit, short.sent, short.lasting) == ("rad/s", 0.5, True)


def test_nothing_is_missing_of_what_was_not_sent():
    assert not any(drive(S, lambda _: FULL, lambda _: (0.0, 0.0, 0.0), mode="hold").values())
