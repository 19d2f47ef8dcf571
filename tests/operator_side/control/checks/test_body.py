"""The check of the body behind z: what it lets pass keeps the body clear on any path, with any lag."""

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from farhand.operator_side.control.checks.body import clear_steps
from farhand.testing import problem

DT, KEPT = 0.1, 0.5
speed = st.floats(-1.0, 1.0)
LET = math.sqrt(KEPT**2 - (math.sqrt(2.0) * DT) ** 2 / 4)  # between two samples of a step at full speed


@settings(max_examples=200, deadline=None)
@given(
    st.floats(0.0, 2 * math.pi), st.floats(0.0, 1.5), st.floats(0.05, 1.5), st.tuples(speed, speed),
    st.lists(st.tuples(speed, speed), min_size=3, max_size=30),
)  # fmt: skip
def test_a_body_whose_plans_are_cut_stays_clear(angle, off, lag, first, wanted):
    x = np.array([math.cos(angle), math.sin(angle), 0.0]) * (KEPT + off)
    v = np.array([*first, 0.0])
    if _gap_of_segment(x, x + lag * v) < KEPT:
        v = np.zeros(3)
    kept = math.exp(-DT / lag)
    for u in wanted:
        z = x + lag * v
        plan = np.tile([*u, 0.0], (4, 1))
        given_problem = problem(position=z, centres=[[0, 0, 0]], radii=[KEPT])
        steps = clear_steps(given_problem, np.array([KEPT]), plan, (v, lag, DT))
        applied = plan[0] if steps else np.zeros(3)
        v = kept * v + (1 - kept) * applied
        x = z + applied * DT - lag * v
        assert np.linalg.norm(x) > LET - 1e-3
        assert _gap_of_segment(x, x + lag * v) > LET - 1e-3


def test_a_robot_that_stands_on_a_margin_may_go_along_it():
    at = problem(position=(0.0, KEPT, 0.0), centres=[[0, 0, 0]], radii=[KEPT])
    plan = np.tile([0.25, 0.0, 0.0], (5, 1)) + np.linspace(0.0, 0.2, 5)[:, None] * [0.0, -0.1, 0.0]
    assert clear_steps(at, np.array([KEPT]), plan, (np.zeros(3), 0.016, DT)) > 0


def test_a_plan_round_a_tight_bend_is_cut_and_one_on_the_straight_is_not():
    at = problem(position=(0.0, 0.6, 0.0), centres=[[0, 0, 0]], radii=[KEPT])
    from_afar = (np.array([0.0, 1.5, 0.0]), 1.0, DT)  # the body is 1.5 m below z, on the other side
    plan = np.tile([1.5, 0.0, 0.0], (5, 1))
    assert clear_steps(at, np.array([KEPT]), plan, (np.array([1.5, 0.0, 0.0]), 1.0, DT)) == 5
    beside = problem(position=(0.6, 0.6, 0.0), centres=[[0, 0, 0]], radii=[KEPT])
    back = np.tile([-1.5, 0.0, 0.0], (5, 1))
    assert clear_steps(beside, np.array([KEPT]), back, from_afar) < 5


def _gap_of_segment(a, b):
    along = b - a
    share = np.clip(-(a @ along) / max(along @ along, 1e-12), 0.0, 1.0)
    return float(np.linalg.norm(a + share * along))
