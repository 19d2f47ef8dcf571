"""What an operator keeps for its recorder: every tick once and in order, however it is asked for."""

from hypothesis import given, settings
from hypothesis import strategies as st

from farhand.common.link.link import Packet
from farhand.operator_side.accounts.tick_history import TickHistory
from farhand.testing import report


def add(history, first, count):
    for number in range(first, first + count):
        packets = [Packet("farhand/r/state", b"x" * 50, number)]
        history.tick(number, packets, b"c", report(number))


@settings(max_examples=50, deadline=None)
@given(st.lists(st.tuples(st.integers(0, 12), st.integers(1, 4000)), max_size=12), st.integers(3, 20))
def test_who_asks_again_and_again_gets_each_tick_once_or_knows_that_it_is_gone(steps, kept):
    history, added, next_, got = TickHistory(kept), 0, 0, []
    for more, size in steps:
        add(history, added, more)
        added += more
        found, left = history.since(next_, size)
        numbers = [tick.number for tick in found]
        assert numbers == list(range(numbers[0], numbers[0] + len(numbers))) if numbers else True
        if numbers:
            assert numbers[0] == max(next_, added - kept)
            next_ = numbers[-1] + 1
        assert left == (next_ < added)
        got += numbers
    assert got == sorted(set(got))
    assert all(tick.packets[0][1] == tick.number == tick.now_ns for tick in history.since(0, 10**9)[0])
