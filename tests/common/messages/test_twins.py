"""Two programs of one name are told from one that was restarted."""

from farhand.common.messages.twins import REMEMBERED, Twins

MS = 1_000_000


def heard(*times_by_session, overlap_ms=500):
    twins = Twins(overlap_ms * MS)
    events = sorted((t, session) for session, times in enumerate(times_by_session, 1) for t in times)
    for t, session in events:
        twins.note(session, t * MS)
    return twins


def test_sessions_that_overlap_are_twins_until_one_is_silent():
    twins = heard(range(0, 3000, 10), range(1000, 3000, 10))
    assert twins.there(3000 * MS)
    assert not twins.there(4001 * MS)


def test_one_session_and_a_restart_are_none():
    assert not heard(range(0, 3000, 10)).there(3000 * MS)
    assert not heard(range(0, 2000, 10), range(2100, 4000, 10)).there(4000 * MS)


def test_what_the_old_session_sent_may_come_late_by_the_networks_jitter():
    late = [*range(0, 2000, 10), 2200, 2400]
    assert not heard(late, range(2100, 2450, 10)).there(2450 * MS)
    assert heard([*late, 2700], range(2100, 2710, 10)).there(2710 * MS)


def test_a_session_that_comes_back_after_a_silence_begins_anew():
    assert not heard([0, 10, 5000], range(4000, 5100, 10)).there(5100 * MS)


def test_memory_is_bounded():
    twins = Twins(500 * MS)
    for k in range(1000):
        twins.note(k, k)
    assert len(twins._heard) == REMEMBERED
