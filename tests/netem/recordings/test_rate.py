"""Packet-delivery traces: bytes leave at the trace's opportunities, first in, first out."""

import pytest

from farhand.common.errors import TraceError
from farhand.netem.recordings.rate import load_rate_trace

MS = 1_000_000


@pytest.fixture
def schedule(tmp_path):
    path = tmp_path / "link.trace"
    # Two packets at 10 ms, one at 20, one at 40; then again.
    path.write_text("10\n10\n20\n40\n")
    return load_rate_trace(path).schedule()


def test_each_message_takes_the_next_opportunities(schedule):
    assert schedule.depart(0, 1500) == 10 * MS
    assert schedule.depart(1 * MS, 1500) == 10 * MS
    assert schedule.depart(2 * MS, 3000) == 40 * MS
    assert schedule.depart(3 * MS, 1) == 50 * MS


def test_small_messages_share_an_opportunity(schedule):
    assert [schedule.depart(0, 500) for _ in range(7)] == [10 * MS] * 6 + [20 * MS]


def test_an_opportunity_that_passed_is_gone(schedule):
    assert schedule.depart(0, 1) == 10 * MS
    assert schedule.depart(15 * MS, 1) == 20 * MS
    assert schedule.depart(41 * MS, 1) == 50 * MS


def test_a_big_message_goes_round(schedule):
    assert schedule.depart(5 * MS, 1500 * 10) == (5 + 80 + 10) * MS


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("", "is empty"),
        ("5\n4\n", "line 2: the time goes"),
        ("5\n-4\n", "line 2"),
        ("1.5\n", "line 1"),
        ("0\n0\n", "infinite"),
    ],
)
def test_errors(tmp_path, content, words):
    path = tmp_path / "t"
    path.write_text(content)
    with pytest.raises(TraceError) as caught:
        load_rate_trace(path)
    assert words in str(caught.value)
