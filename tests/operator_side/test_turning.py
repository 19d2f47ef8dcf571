"""The turning beside a plan: within its limit, and not longer than the plan moves."""

import numpy as np
import pytest

from farhand.operator_side.control.controller import ControlSolution, Status
from farhand.operator_side.safety_filter import Filtered
from farhand.operator_side.turning import limited, turning_plan

TURN = (0.0, 0.6, 0.8)


def filtered(moving, reason=""):
    plan = np.zeros((10, 3))
    plan[:moving, 0] = 0.1
    return Filtered(plan, ControlSolution(plan, Status.OPTIMAL), "", reason)


def test_it_is_limited_about_whatever_axis():
    assert limited(TURN, 0.5) == pytest.approx((0.0, 0.3, 0.4))
    assert limited(TURN, 1.0) == TURN
    assert limited(TURN, 0.0) == (0.0, 0.0, 0.0)


def test_it_is_held_through_a_plan_that_nothing_cut_even_one_that_stands():
    assert turning_plan(TURN, 1.0, filtered(10), 10) == (TURN,) * 10
    assert turning_plan(TURN, 1.0, filtered(0), 10) == (TURN,) * 10


def test_it_stops_where_safety_stops_the_tool():
    assert turning_plan(TURN, 1.0, filtered(0, "inside a margin: stopped"), 10) == ()
    assert turning_plan(TURN, 1.0, filtered(3, "plan cut after 3 steps"), 10) == (TURN,) * 3
    assert turning_plan(TURN, 1.0, None, 10) == ()
    assert turning_plan((0.0, 0.0, 0.0), 1.0, filtered(10), 10) == ()
