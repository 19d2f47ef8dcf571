"""From inside a margin that grew over the robot: never deeper, and out of it."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from farhand.operator_side.control.checks.fallback import safe_plan
from farhand.operator_side.control.checks.recovery import JUST_OUTSIDE, eased
from farhand.operator_side.control.registry import make_controller
from farhand.operator_side.control.settings import ControllerSettings
from farhand.testing import problem as make_problem

SETTINGS = ControllerSettings()
CONTROLLER = make_controller(SETTINGS)
CONTROLLER.prepare()
LIMIT = np.array(SETTINGS.speed_limit)

unit = st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda v: np.linalg.norm(v) > 0.1)
obstacle = st.tuples(unit, st.floats(0.05, 0.5), st.floats(0.0, 0.6), st.sampled_from([0.0, 0.0, 0.01]))
desired = st.tuples(*[st.floats(-0.5, 0.5)] * 3)


def problem_of(position, wanted, obstacles):
    """Obstacles by the direction in which they lie, their radius, and how deep the robot is in (share)."""
    directions = np.array([np.array(d) / np.linalg.norm(d) for d, *_ in obstacles])
    radii = np.array([r for _, r, _, _ in obstacles])
    depth = np.array([share * r for _, r, share, _ in obstacles])
    centres = position + directions * (radii - depth)[:, None]
    return make_problem(position, wanted, centres, radii, sigma=[s for *_, s in obstacles])


def room(problem, position):
    away = position - problem.centres
    return np.sum(away**2, axis=1) - problem.radii**2 - problem.sigmas


def plan_of(problem):
    CONTROLLER.reset()
    plan, _ = safe_plan(problem, CONTROLLER.solve(eased(problem, SETTINGS) or problem), SETTINGS)
    return plan


@given(desired, st.lists(obstacle, min_size=1, max_size=4))
def test_no_plan_drives_deeper_into_any_margin(wanted, obstacles):
    problem = problem_of((0.2, -0.1, 0.4), wanted, obstacles)
    plan = plan_of(problem)
    assert np.all(np.isfinite(plan))
    assert np.all(np.abs(plan) <= LIMIT + 1e-6)
    position, before = problem.position, room(problem, problem.position)
    for velocity in plan:
        position = position + SETTINGS.period * velocity
        after = room(problem, position)
        inside = before < -2e-5
        assert np.all(after[inside] >= before[inside] - 1e-9)
        assert np.all(after[~inside] >= -1e-4)
        before = after


@given(desired, unit, st.floats(0.1, 0.5), st.floats(0.02, 0.5), st.sampled_from([0.0, 0.02]))
def test_out_of_a_single_margin_whatever_is_desired(wanted, direction, radius, share, sigma):
    problem = problem_of((0.0, 0.0, 0.0), wanted, [(direction, radius, share, sigma)])
    reach = np.sqrt(radius**2 + sigma)
    position, ticks = problem.position, 0
    while room(problem, position)[0] < -1e-3 * reach**2:
        position = position + SETTINGS.period * plan_of(replace(problem, position=position))[0]
        ticks += 1
        assert ticks < 150, "it stays inside"


@given(desired, st.lists(obstacle, min_size=1, max_size=4))
def test_the_eased_problem_is_the_same_but_for_the_margins_around_the_robot(wanted, obstacles):
    problem = problem_of((0.2, -0.1, 0.4), wanted, obstacles)
    easier = eased(problem, SETTINGS)
    gaps = np.linalg.norm(problem.position - problem.centres, axis=1)
    reach = np.sqrt(problem.radii**2 + problem.sigmas)
    assume(np.all(np.abs(gaps - reach) > 1e-12))  # on the very edge, rounding decides
    inside = gaps < reach
    if easier is None:
        assert not inside.any()
        return
    assert np.array_equal(easier.centres, problem.centres)
    assert easier.radii[inside] == pytest.approx(gaps[inside] * JUST_OUTSIDE)
    assert np.array_equal(easier.radii[~inside], problem.radii[~inside])
    assert np.all(easier.sigmas[inside] == 0.0)
    deepest = int(np.argmin(gaps - reach))
    normal = (problem.position - problem.centres[deepest]) / gaps[deepest]
    if inside.sum() == 1:
        assert normal @ easier.desired > 0.0


def test_outside_every_margin_nothing_is_eased():
    problem = problem_of((0, 0, 0), (0.1, 0, 0), [((1, 0, 0), 0.3, -0.5, 0.0)])
    assert eased(problem, SETTINGS) is None


def test_a_robot_at_the_very_centre_does_not_divide_by_zero():
    problem = problem_of((0, 0, 0), (0.1, 0, 0), [((1, 0, 0), 0.3, 1.0, 0.0)])
    assert eased(problem, SETTINGS) is None
    assert np.all(np.isfinite(plan_of(problem)))
