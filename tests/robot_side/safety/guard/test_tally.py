"""What the guard did is counted, timed, and told once."""

import pytest

from farhand.common.messages.intervention import Intervention
from farhand.robot_side.safety.guard.tally import MOST_PAIRS, Tally


def _did(what="slowed", obstacle="post", distance=0.03):
    return Intervention(
        part="forearm", obstacle=obstacle, distance=distance, limit=0.013, asked=0.3, done=0.1, what=what
    )


def test_what_follows_soon_is_the_same_intervention():
    tally = Tally(0.01)
    for t in (0.0, 0.01, 0.3, 0.9, 0.91):
        tally.add(_did(), round(t * 1e9))
        tally.add(None, round(t * 1e9) + 5_000_000)
    assert tally.times == 2
    assert tally.seconds == pytest.approx(0.05)
    assert tally.deeds == {"slowed": pytest.approx(0.05)}


def test_what_it_does_no_more_is_not_told():
    tally = Tally(0.01)
    tally.add(_did("evading"), 0)
    tally.forget()
    assert tally.take() is None
    assert tally.times == 1


def test_pairs_keep_their_time_and_their_least_distance():
    tally = Tally(0.01)
    tally.add(_did(distance=0.05), 0)
    tally.add(_did("braking", distance=0.02), 1)
    tally.add(_did(obstacle="wall"), 2)
    assert tally.pairs["forearm", "post"] == (pytest.approx(0.02), 0.02)
    assert tally.pairs["forearm", "wall"] == (pytest.approx(0.01), 0.03)
    for i in range(2 * MOST_PAIRS):
        tally.add(_did(obstacle=f"o{i}"), i)
    assert len(tally.pairs) == MOST_PAIRS


def test_the_newest_is_told_once():
    tally = Tally(0.01)
    assert tally.take() is None
    tally.add(_did(distance=0.03), 0)
    tally.add(_did(distance=0.02), 1)
    tally.add(None, 2)
    assert tally.take() == _did(distance=0.02)
    assert tally.take() is None
