import threading

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from farhand.common.timing.handoff import Handoff


@settings(max_examples=30)
@given(st.lists(st.integers(), max_size=50))
def test_all_is_done_in_order(items):
    done = []
    handoff = Handoff(done.append, "work", 100)
    assert [handoff.put(item) for item in items] == [True] * len(items)
    assert handoff.close()
    assert done == items


def test_what_finds_no_place_is_counted_and_never_waited_for():
    free, taken, done = threading.Event(), threading.Event(), []

    def work(item):
        taken.set()
        free.wait(10)
        done.append(item)

    handoff = Handoff(work, "work", 3)
    assert handoff.put(0)
    assert taken.wait(10)
    assert [handoff.put(n) for n in (1, 2, 3, 4, 5)] == [True, True, True, False, False]
    assert handoff.lost == 2
    assert not handoff.close(0.0)
    free.set()
    assert handoff.close()
    assert done == [0, 1, 2, 3]


def test_who_may_wait_loses_nothing():
    done = []
    handoff = Handoff(done.append, "work", 2)
    for n in range(500):
        handoff.put_waiting(n)
    handoff.close()
    assert done == list(range(500))
    assert handoff.lost == 0


def test_a_queue_without_a_place_is_none():
    with pytest.raises(ValueError, match="one thing"):
        Handoff(print, "work", 0)
