"""What lag costs: the closed form, and robots that trail behind z on paths of any kind."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from farhand.laboratory.simulation import simulate
from farhand.operator_side.margins.lag import radii_for_lag, trails_that_fit
from farhand.operator_side.margins.trail import SLOWEST, Trail
from farhand.runs.scenario import load_scenario, replace_settings

radius = st.floats(0.01, 5.0)
trail = st.floats(0.0, 5.0)


@given(radius, trail)
def test_on_the_circle_of_z_the_body_keeps_its_own(kept, trailing):
    (outer,) = radii_for_lag(np.array([kept]), np.array([trailing]))
    rate = trailing / outer  # lag V / R: angle that z goes round in one lag
    assert outer / math.sqrt(1.0 + rate * rate) == pytest.approx(kept)
    assert kept <= outer <= kept + trailing / 2 + 1e-12
    assert trails_that_fit(np.array([kept]), np.array([outer]))[0] == pytest.approx(trailing, abs=1e-6)


def test_no_lag_costs_nothing_and_small_lag_half_its_square():
    radii = np.array([0.3, 0.7])
    assert radii_for_lag(radii, np.zeros(2)).tolist() == radii.tolist()
    small = np.array([1e-3, 2e-3])
    assert radii_for_lag(radii, small) - radii == pytest.approx(small**2 / (2 * radii), rel=1e-3)


def test_a_wish_is_slowed_down_only_where_its_lag_part_would_grow_over_z():
    own = Trail((1.0, 1.0, 1.0), 1.0)
    wanted, radii, still = np.array([1.0, 0.0, 0.0]), np.array([0.5]), np.zeros(1)
    assert own.desired(wanted, radii, np.array([5.0]), still) is wanted
    slowed = own.desired(wanted, radii, np.array([0.6]), still)
    assert own.radii(radii, slowed, 0.0, still)[0] == pytest.approx(0.6)
    assert np.linalg.norm(own.desired(wanted, radii, np.array([0.1]), still)) >= SLOWEST - 1e-9
    assert own.desired(wanted, np.zeros(0), np.zeros(0), np.zeros(0)) is wanted


def test_who_is_held_up_slows_down_step_by_step_and_is_let_go_again():
    own = Trail((1.0, 1.0, 1.0), 1.0)
    wanted, far = np.array([1.0, 0.0, 0.0]), (np.array([0.5]), np.array([9.0]), np.zeros(1))
    for _ in range(100):
        own.learn(wanted, np.zeros(3), 0.3)
    assert np.linalg.norm(own.desired(wanted, *far)) == pytest.approx(SLOWEST)
    for _ in range(100):
        own.learn(wanted, wanted, 0.3)
    assert own.desired(wanted, *far) is wanted
    own.learn(wanted, np.zeros(3), 0.001)  # nothing to be gained by slowing down
    assert own.desired(wanted, *far) is wanted


@pytest.mark.parametrize("lag", [0.3, 0.5, 2.0])
def test_a_slow_robot_goes_round_the_obstacle(lag):
    # The operator's side alone: the guard would keep a robot that needs seconds to stop far from everything.
    scenario = replace_settings(load_scenario("point-obstacle"), {"robot.lag": lag, "guard.on": False})
    result = simulate(scenario, uplink="none", downlink="none", keep_reports=True)
    assert result.summary.safe
    assert result.summary.finished
    assert max(report.margin_parts.get("lag", 0.0) for report in result.reports) > 0.01
