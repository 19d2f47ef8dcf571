"""Margin laws."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from farhand.operator_side.margins.law import MarginInput
from farhand.operator_side.margins.registry import make_margin
from farhand.operator_side.margins.settings import MarginSettings

GIVEN = MarginInput(speed=0.4, rtt_mean=0.1, rtt_std=0.02, innovation=0.03, spread=0.05)


def law(kind, **changes):
    return make_margin(MarginSettings(kind=kind, own={kind: changes}))


def test_no_margin():
    margin = law("none").evaluate(GIVEN)
    assert (margin.sigma, margin.inflation) == (0.0, 0.0)


def test_the_papers_margin():
    margin = law("paper", k_sigma=2.0, max_speed=0.5).evaluate(GIVEN)
    assert margin.sigma == pytest.approx(0.4 * 0.1 + 0.5 * 2.0 * 0.02)
    assert margin.inflation == 0.0
    assert margin.sigma == pytest.approx(sum(margin.parts.values()))


nonnegative = st.floats(0, 10)


@given(nonnegative, nonnegative)
def test_the_adaptive_margin_is_the_largest_of_its_parts_within_its_bounds(innovation, spread):
    margin = law("adaptive", floor=0.02, cap=0.3).evaluate(MarginInput(1.0, 9.0, 9.0, innovation, spread))
    assert margin.sigma == 0.0
    assert 0.02 <= margin.inflation <= 0.3
    assert margin.inflation == min(0.3, max(0.02, innovation, spread))
    assert margin.parts == {"floor": 0.02, "innovation": innovation, "spread": spread}


@given(nonnegative, nonnegative)
def test_the_floor_grows_with_the_way_in_an_error_of_time_and_ends(speed, more):
    own = {"floor": 0.02, "least": 0.004, "timing": 0.1}
    here, faster = (
        law("adaptive", **own).evaluate(MarginInput(v, 0.2, 0.1, 0.0, 0.0)).inflation
        for v in (speed, speed + more)
    )
    assert 0.004 <= here <= faster <= 0.02
    assert here == pytest.approx(min(0.02, 0.004 + 0.1 * speed))
    constant = law("adaptive", floor=0.02, least=0.02).evaluate(MarginInput(speed, 0.2, 0.1, 0.0, 0.0))
    assert constant.inflation == 0.02


def test_the_worst_case_is_the_way_of_the_worst_delay_whatever_is_measured():
    law = make_margin(
        MarginSettings(kind="worst-case", own={"worst-case": {"speed": 0.5, "delay": 0.4, "extra": 0.03}})
    )
    for seen in (MarginInput(0.0, 0.0, 0.0, 0.0, 0.0), MarginInput(0.5, 0.2, 0.1, 0.3, 0.3)):
        assert law.evaluate(seen).inflation == pytest.approx(0.23)
        assert law.evaluate(seen).sigma == 0.0


@given(nonnegative, nonnegative, nonnegative, nonnegative, st.floats(0, 1))
def test_the_watchful_margin_is_never_less_than_the_papers_and_grows_with_what_is_not_known(
    rtt, std, age, newest, loss
):
    paper, watchful = law("paper", k_sigma=2.0), law("watchful", k_sigma=2.0)
    calm = MarginInput(0.3, rtt, std, 0.0, 0.0)
    given = MarginInput(0.3, rtt, std, 0.0, 0.0, rtt_newest=newest, age=age, loss=loss)
    assert watchful.evaluate(calm).sigma == pytest.approx(paper.evaluate(calm).sigma)
    margin = watchful.evaluate(given)
    assert margin.sigma >= watchful.evaluate(calm).sigma - 1e-9
    assert margin.sigma == pytest.approx(sum(margin.parts.values()))
    assert watchful.round_trip(given) >= max(paper.round_trip(given), age, newest)


def test_a_law_that_does_not_reckon_with_round_trips_says_so():
    assert law("adaptive").round_trip(GIVEN) is law("none").round_trip(GIVEN) is None
