"""Echo, links, seeds and time: what holds for any order of events."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from farhand.common.link.link import Inbox, Packet
from farhand.common.messages.echo import Newest
from farhand.common.seeds import stream
from farhand.common.timing.clock import to_ns, to_seconds
from farhand.common.timing.lateness import Lateness
from farhand.common.timing.periodic import Periodic
from farhand.testing import command


@given(st.lists(st.integers(0, 50), min_size=1))
def test_the_echo_is_the_newest_by_seq_and_never_goes_back(seqs):
    newest, best, accepted = Newest(), -1, 0
    for now, seq in enumerate(seqs):
        assert newest.accept(command(seq), now) == (seq > best)
        accepted += seq > best
        best = max(best, seq)
        echo = newest.echo(now + 5)
        assert (echo.seq, echo.t_sent_ns) == (best, command(best).t_sent_ns)
        assert echo.hold_ns == now + 5 - newest.arrived_ns
    assert newest.received == accepted


def test_nothing_received_has_no_echo_and_a_new_session_starts_anew():
    newest = Newest()
    assert newest.echo(5) is None
    assert newest.accept(command(900, session=1), 10)
    assert newest.accept(command(0, session=2), 20)
    assert newest.echo(25).session == 2
    assert newest.received == 1
    assert newest.echo(15).hold_ns == 0


@given(st.lists(st.tuples(st.integers(1, 4), st.integers(0, 30)), max_size=40))
def test_a_session_that_was_left_is_not_gone_back_to_until_it_is_long_ago(steps):
    """Whoever restarts has a new session; what the old one sent may come late."""
    newest, left, now = Newest(left_ns=20), {}, 0
    for number, (session, later) in enumerate(steps):
        now += later
        current = newest.session
        accepted = newest.accept(command(number, session=session), now)
        assert accepted == (now - left.get(session, -20) >= 20 or session == current)
        if accepted and session != current:
            left[current] = now
        left.pop(newest.session, None)


@given(st.integers(1, 20), st.lists(st.integers(0, 3)))
def test_an_inbox_keeps_the_newest_and_counts_the_rest(limit, drains):
    inbox, expected, dropped = Inbox(limit), [], 0
    for number, drain in enumerate(drains):
        inbox.put(Packet("k", b"%d" % number))
        expected.append(b"%d" % number)
        if len(expected) > limit:
            expected.pop(0)
            dropped += 1
        if drain == 0:
            assert [p.payload for p in inbox.drain()] == expected
            expected = []
    assert [p.payload for p in inbox.drain()] == expected
    assert inbox.overflowed == dropped
    assert inbox.drain() == []


@given(st.integers(1, 1000), st.lists(st.integers(0, 5000), min_size=1))
def test_periodic_counts_every_period_once(period, gaps):
    periodic, now, total = Periodic(period), 0, 0
    for gap in gaps:
        now += gap
        total += periodic.due(now)
        assert periodic.due(now) == 0
        assert now < periodic.next_ns <= now + period
    first = gaps[0]
    assert total == 1 + (now - first) // period
    assert (periodic.next_ns - first) % period == 0


@given(st.lists(st.integers(-10, 10**9), min_size=1), st.floats(0.01, 1.0))
def test_lateness_bounds_its_quantiles(late, fraction):
    found = Lateness()
    for value in late:
        found.add(value)
    assert found.count == len(late)
    assert found.max_ns == max(0, *late)
    assert found.total_ns == sum(max(0, v) for v in late)
    edge = to_ns(found.quantile(fraction))
    share = np.mean([max(0, v) <= edge for v in late])
    assert share >= fraction - 1e-9
    assert edge <= max(1000, 2 * max(0, *late) + 1000)


def test_lateness_of_nothing_is_zero():
    assert Lateness().quantile(0.99) == 0.0


names = st.lists(st.text(alphabet="abcdef", min_size=1, max_size=6), min_size=1, max_size=3)


@given(st.integers(0, 2**40), st.permutations([("a",), ("b",), ("a", "b"), ("netem", "up")]))
def test_a_stream_depends_on_seed_and_names_alone(seed, order):
    drawn = {key: stream(seed, *key).random(3).tolist() for key in order}
    assert drawn == {key: stream(seed, *key).random(3).tolist() for key in sorted(order)}
    assert len({tuple(v) for v in drawn.values()}) == len(order)


@given(st.integers(0, 2**30), names, names)
def test_streams_with_other_names_or_seeds_differ(seed, one, other):
    draws = tuple(stream(seed, *one).random(2))
    assert draws != tuple(stream(seed + 1, *one).random(2))
    if "/".join(one) != "/".join(other):
        assert draws != tuple(stream(seed, *other).random(2))


@given(st.integers(0, 10**15))
def test_seconds_and_nanoseconds_agree(duration_ns):
    assert to_ns(to_seconds(duration_ns)) == duration_ns
