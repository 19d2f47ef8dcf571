"""A plan that would drive deeper in is never sent, whatever the solver said."""

from dataclasses import replace

import numpy as np
from hypothesis import example, given, settings
from hypothesis import strategies as st
from msgspec import structs

from farhand.common.seeds import stream
from farhand.operator_side.control.checks.fallback import NEAR, safe_plan
from farhand.operator_side.control.controller import ControlProblem, ControlSolution, Status
from farhand.operator_side.control.newton import NewtonController
from farhand.operator_side.control.settings import ControllerSettings
from farhand.testing import problem as make_problem

SETTINGS = ControllerSettings()
SEEDS = st.integers(0, 2**32 - 1)
CHECKED = [Status.ELASTIC, Status.CAPPED, Status.INFEASIBLE]
FINE = 50  # points along each step
INSIDE = make_problem((0.14, 0.0, 0.0), (0.0, 0.0, 0.0), centres=[(0.0, 0.0, 0.0)], radii=[0.15])


def random_problem(seed, moving):
    """Around the start, often inside a margin, sometimes inside an obstacle."""
    rng = stream(seed, "fallback")
    n = int(rng.integers(1, 6))
    away = rng.normal(size=(n, 3))
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    radii = rng.uniform(0.07, 0.4, n)
    return ControlProblem(
        np.zeros(3),
        rng.uniform(-0.3, 0.3, 3),
        away * (radii + rng.uniform(-0.06, 0.2, n))[:, None],
        radii,
        rng.uniform(-0.2, 0.2, (n, 3)) if moving else np.zeros((n, 3)),
        rng.choice([0.0, 0.003, 0.03]) * np.ones(n),
    )


def room_along(problem, plan, dt):
    """(n, N, FINE+1) values of h - sigma along each step, and what they were if each step stood still."""
    position = np.zeros(3)
    share = np.linspace(0, 1, FINE + 1)[:, None] * dt
    moved, stood = [], []
    for i, u in enumerate(plan):
        for j in range(len(problem.radii)):
            obstacle = problem.centres[j] + (i * dt + share) * problem.velocities[j]
            bound = problem.radii[j] ** 2 + problem.sigmas[j]
            moved.append(np.sum((position + share * u - obstacle) ** 2, axis=1) - bound)
            stood.append(np.sum((position - obstacle) ** 2, axis=1) - bound)
        position = position + dt * u
    shape = (len(plan), len(problem.radii), FINE + 1)
    return np.reshape(moved, shape), np.reshape(stood, shape)


def assert_never_deeper(problem, plan, dt):
    """Nowhere along the plan nearer than both the start of the step and standing still."""
    moved, stood = room_along(problem, plan, dt)
    for i in range(len(plan)):
        for j in range(len(problem.radii)):
            start = moved[i, j, 0]
            if start < -NEAR:
                assert np.all(moved[i, j] >= np.minimum(start, stood[i, j]) - 1e-9)
            else:
                assert moved[i, j, -1] >= min(-NEAR, stood[i, j, -1]) - 1e-9


@settings(deadline=None, max_examples=200)
@given(SEEDS, st.sampled_from(CHECKED), st.booleans())
@example(1053549, Status.ELASTIC, True)  # an obstacle that turns away within the step
def test_any_plan_with_a_status_that_is_not_good(seed, status, moving):
    problem = random_problem(seed, moving)
    wild = stream(seed, "wild").uniform(-0.3, 0.3, (SETTINGS.horizon, 3))
    plan, _ = safe_plan(problem, ControlSolution(wild, status), SETTINGS)
    assert_never_deeper(problem, plan, SETTINGS.period)
    cut = int(np.argmax(np.any(plan != wild, axis=1))) if np.any(plan != wild) else SETTINGS.horizon
    assert np.array_equal(plan[:cut], wild[:cut])
    assert not plan[cut:].any()


@settings(deadline=None, max_examples=150)
@given(SEEDS, st.booleans(), st.sampled_from(["newton", "far"]))
def test_what_the_solver_really_says_from_anywhere(seed, moving, way):
    problem = random_problem(seed, moving)
    if way == "far":  # fast enough to pass through small obstacles
        problem = replace(problem, desired=4 * problem.desired)
    controller = NewtonController(SETTINGS)
    for _ in range(3):
        solution = controller.solve(problem)
        plan, reason = safe_plan(problem, solution, SETTINGS)
        assert_never_deeper(problem, plan, SETTINGS.period)
        assert np.array_equal(plan, solution.plan) == (not reason)


@settings(deadline=None, max_examples=50)
@given(SEEDS)
def test_a_good_plan_from_outside_is_sent_as_it_is(seed):
    problem = random_problem(seed, False)
    solution = NewtonController(SETTINGS).solve(problem)
    room = np.sum((problem.position - problem.centres) ** 2, axis=1) - problem.radii**2 - problem.sigmas
    if solution.status.good and room.min() >= 0:
        plan, reason = safe_plan(problem, solution, SETTINGS)
        assert plan is solution.plan
        assert reason == ""


@settings(deadline=None, max_examples=50)
@given(SEEDS, st.sampled_from([Status.BAD_INPUT, Status.FAILED]))
def test_no_answer_is_a_stop(seed, status):
    problem = random_problem(seed, True)
    wild = np.full((SETTINGS.horizon, 3), 0.3)
    plan, reason = safe_plan(problem, ControlSolution(wild, status), SETTINGS)
    assert not plan.any()
    assert reason


def test_a_plan_that_is_not_finite_is_a_stop():
    problem = random_problem(1, False)
    wild = np.full((SETTINGS.horizon, 3), np.nan)
    for status in CHECKED:
        plan, reason = safe_plan(problem, ControlSolution(wild, status), SETTINGS)
        assert not plan.any()
        assert reason


def test_leaving_is_allowed_and_entering_is_not():
    out = np.tile([0.2, 0.0, 0.0], (10, 1))
    for status in CHECKED:
        assert safe_plan(INSIDE, ControlSolution(out, status), SETTINGS)[1] == ""
        plan, reason = safe_plan(INSIDE, ControlSolution(-out, status), SETTINGS)
        assert not plan.any()
        assert "stopped" in reason
    # even where the far side would be reached within one step
    leap = structs.replace(SETTINGS, period=1.0, speed_limit=(1.0, 1.0, 1.0))
    plan, _ = safe_plan(INSIDE, ControlSolution(-5 * out, Status.CAPPED), leap)
    assert not plan.any()


def test_an_optimal_plan_deeper_in_is_not_sent_either():
    """From inside, through the obstacle can be a local optimum of the paper's problem."""
    through = np.tile([-0.2, 0.0, 0.0], (10, 1))
    plan, reason = safe_plan(INSIDE, ControlSolution(through, Status.OPTIMAL), SETTINGS)
    assert not plan.any()
    assert reason


def test_pass_through_is_left_alone():
    problem = random_problem(1, False)
    wild = np.full((SETTINGS.horizon, 3), 0.3)
    bare = structs.replace(SETTINGS, kind="pass-through")
    assert safe_plan(problem, ControlSolution(wild, Status.ELASTIC), bare)[0] is wild
