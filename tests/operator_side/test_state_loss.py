"""The share of states that never came: true from the first figure on, at any rate of states, through a restart."""

import pytest

from farhand.common.seeds import stream as draws
from farhand.operator_side.sensing.state_loss import JUMP, SETTLE, WINDOW, StateLoss
from farhand.testing import state

RATES = (50, 100, 500)


def stream(loss, seqs, rate=50, session=9):
    """Hand over states in this order; the figures after each."""
    found = []
    for seq in seqs:
        loss.received(state(seq, session=session, t_sent_ns=round(seq * 1e9 / rate)))
        found.append(loss.share)
    return found


def late(count, rate, longest, begin, seed):
    """Numbers in the order of arrival, each late by up to `longest` s, of those that come after `begin` s."""
    delays = draws(seed, "late").uniform(0.0, longest, count)
    arrivals = sorted((seq / rate + delay, seq) for seq, delay in enumerate(delays))
    return [seq for at, seq in arrivals if at >= begin]


@pytest.mark.parametrize("rate", RATES)
def test_who_connects_in_the_middle_of_late_states_lost_none_of_them(rate):
    """Those that came before it was there are no loss: over uniform:50,200 they were shown as one of up to 50 %."""
    for seed in range(10):
        figures = stream(StateLoss(), late(6 * rate, rate, 0.15, 2.0, seed), rate)
        assert set(figures) == {None, 0.0}


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("every", [0, 4, 10])
def test_the_share_is_that_of_the_states_that_never_came(rate, every):
    seqs = [seq for seq in range(8 * rate) if not every or seq % every]
    newest, figures = seqs[-1], stream(StateLoss(), seqs, rate)
    looked_at = range(newest - round(WINDOW * rate) + 1, newest - round(SETTLE * rate) + 1)
    lost = sum(1 for seq in looked_at if every and seq % every == 0)
    assert figures[-1] == pytest.approx(lost / len(looked_at), abs=0.002)
    shown = [figure for figure in figures if figure is not None]
    assert max(shown) <= (1 / every + 0.02 if every else 0.0)


def test_what_may_yet_come_does_not_count_and_what_comes_late_is_not_lost():
    """A jump from 600 ms to nothing at 100 states a second: sixty are overtaken."""
    loss = StateLoss()
    stream(loss, range(500), 100)
    assert set(stream(loss, [560, *range(500, 560), *range(561, 800)], 100)) == {0.0}
    figures = stream(loss, [*range(800, 850), *range(860, 1100), *range(850, 860), *range(1100, 1200)], 100)
    assert max(figures) == pytest.approx(10 / 300)
    assert figures[-1] == 0.0


def test_nothing_is_said_before_anything_is_known():
    figures = stream(StateLoss(), range(200))
    assert figures[:148] == [None] * 148
    assert figures[150:] == [0.0] * 50


def test_a_robot_that_starts_again_counts_from_anew():
    loss = StateLoss()
    assert stream(loss, range(1000))[-1] == 0.0
    assert set(stream(loss, range(300), session=10)) == {None, 0.0}
    assert set(stream(loss, range(300 + 2 * JUMP, 500 + 2 * JUMP), session=10)) == {None, 0.0}


def test_one_that_comes_twice_or_from_long_ago_changes_nothing():
    loss = StateLoss()
    stream(loss, range(600))
    assert set(stream(loss, [600, 3, 601, 601, 4, 602])) == {0.0}
    assert set(stream(loss, [seq for seq in range(603, 900) for _ in range(2)])) == {0.0}


def test_an_outage_is_seen_when_it_is_over():
    figures = stream(StateLoss(), [*range(400), *range(500, 800)])
    assert figures[399] == 0.0
    assert max(figures[399:]) == pytest.approx(100 / 150, abs=0.01)
    assert figures[-1] == 0.0
