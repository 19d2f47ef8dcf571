"""What may be shown: nothing old is live, nothing is newer than what it came with, and a silence is said."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from farhand.runs.freshness import Ages, Freshness, Hearing, freshness, picture
from farhand.testing import report

S = 1_000_000_000
LIVE, OLD, GONE, WAITING = Freshness.LIVE, Freshness.OLD, Freshness.GONE, Freshness.WAITING
ages = st.none() | st.floats(0.0, 1e5)


@pytest.mark.parametrize(
    ("age", "found"),
    [
        (None, WAITING),
        (0.0, LIVE),
        (1.0, LIVE),
        (1.001, OLD),
        (3.0, OLD),
        (3.001, GONE),
        (1e5, GONE),
        (float("nan"), GONE),
    ],
)
def test_ages(age, found):
    assert freshness(age) is found


@given(ages, st.floats(0.0, 1e5), st.booleans(), st.booleans())
def test_nothing_old_is_live_and_every_silence_is_said(report_age, more, connected, robot_connected):
    state_age = None if report_age is None else report_age + more
    found = picture(Ages(report_age, state_age), connected=connected, robot_connected=robot_connected)
    order = [LIVE, OLD, GONE, WAITING]
    assert order.index(found.robot) >= order.index(found.operator)
    assert (found.operator is LIVE) == (report_age is not None and report_age <= 1.0)
    assert (found.robot is LIVE) == (state_age is not None and state_age <= 1.0)
    assert found.running == (found.said == "")
    if GONE in (found.operator, found.robot):
        assert "GONE" in found.said or found.operator is OLD


@given(
    st.lists(
        st.tuples(
            st.integers(0, 4 * S),  # pause before the arrival
            st.integers(0, 3),  # ticks since the last report: 0 is the same one again
            st.integers(0, 3),  # states since
            st.floats(0.0, 10.0),  # what the sender claims to be the state's age
        ),
        max_size=12,
    ),
    st.integers(0, 20 * S),
)
def test_only_what_is_new_refreshes_and_a_claim_can_only_make_it_older(events, wait_ns):
    hearing, now_ns, tick, states = Hearing(), 0, 0, 1
    new_report_ns = new_state_ns = None
    for pause_ns, ticks, fresh, claimed in events:
        now_ns, tick, states = now_ns + pause_ns, tick + ticks, states + (fresh if ticks else 0)
        is_new = hearing.take(report(tick, states=states, safety="run", state_age=claimed), now_ns)
        assert is_new == (ticks > 0 or new_report_ns is None)
        if is_new and (fresh or new_state_ns is None):
            new_state_ns = now_ns
        if is_new:
            new_report_ns = now_ns
    found = hearing.ages(now_ns + wait_ns)
    if new_report_ns is None:
        assert found == Ages()
        return
    assert found.report == pytest.approx((now_ns + wait_ns - new_report_ns) / S)
    assert found.state >= max(found.report, (now_ns + wait_ns - new_state_ns) / S) - 1e-9


def test_who_is_gone_is_said():
    assert picture(Ages(), connected=False).said.startswith("waiting for the operator:")
    assert picture(Ages()).said == "waiting for the operator's first report"
    assert picture(Ages(0.1)).said == "waiting for the robot's first state"
    assert picture(Ages(1.4, 1.4)).said == "no report from the operator for 1.4 s"
    assert "OPERATOR GONE: no report for 11.0 s" in picture(Ages(11.0, 11.0), connected=False).said
    assert picture(Ages(0.1, 1.4)).said == "no state from the robot for 1.4 s"
    assert picture(Ages(0.1, 4.0)).said.startswith("ROBOT GONE: no state for 4.0 s")
    assert picture(Ages(0.1, 4.0), robot_connected=False).said.startswith("ROBOT AND NETWORK GONE")


def test_a_new_session_begins_anew_and_a_robot_that_never_was_is_waited_for():
    hearing = Hearing()
    hearing.take(report(50, session=1, safety="run", states=900), 0)
    assert hearing.picture(S // 2).running
    assert hearing.take(report(0, session=2), S)
    assert hearing.picture(S).robot is WAITING
    assert hearing.take(report(1, session=2, safety="hold", states=1, state_age=0.05), 2 * S)
    assert hearing.picture(2 * S).running
