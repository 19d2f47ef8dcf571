"""What may change nothing: the order of obstacles, mirrors, turns by axes, shifts, obstacles far away."""

from dataclasses import replace
from itertools import permutations, product

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from farhand.common.seeds import stream
from farhand.operator_side.control import newton_kernel as kernel
from farhand.operator_side.control.barrier import subset
from farhand.operator_side.control.controller import ControlProblem, Status
from farhand.operator_side.control.newton import NewtonController, kernel_parameters, tracking_hessian
from farhand.operator_side.control.settings import ControllerSettings
from farhand.operator_side.control.tracking import unconstrained_gains

SETTINGS = ControllerSettings()
TURNS = [
    np.array([[signs[i] * (order[i] == k) for k in range(3)] for i in range(3)], dtype=float)
    for order in permutations(range(3))
    for signs in product((1, -1), repeat=3)
]
SEEDS = st.integers(0, 2**32 - 1)


def random_problem(seed, at_least=1):
    """Three to six obstacles near by, the start outside them."""
    rng = stream(seed, "symmetry")
    n = int(rng.integers(at_least, 7))
    away = rng.normal(size=(n, 3))
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    radii = rng.uniform(0.08, 0.3, n)
    moving = rng.uniform(-0.1, 0.1, (n, 3)) * (rng.random() < 0.5)
    position = rng.uniform(-0.5, 0.5, 3)
    return ControlProblem(
        position,
        rng.uniform(-0.25, 0.25, 3),
        position + away * (radii + rng.uniform(0.03, 0.3, n))[:, None],
        radii,
        moving,
        rng.uniform(0, 0.005, n),
    )


def solve(problem):
    return NewtonController(SETTINGS).solve(problem)


def assert_alike(first, second, turn=None):
    """The same answer where the first is an optimum; rounding may tip a capped one."""
    plan = first.plan if turn is None else first.plan @ turn.T
    assume(first.status.good)
    assert second.status is first.status
    assert np.abs(second.plan - plan).max() < 1e-4
    assert second.cost == pytest.approx(first.cost, rel=1e-3, abs=1e-6)


@settings(deadline=None, max_examples=60)
@given(SEEDS)
def test_the_order_of_obstacles(seed):
    problem = random_problem(seed, 2)
    order = stream(seed, "order").permutation(len(problem.radii))
    assert_alike(solve(problem), solve(subset(problem, order)))


@settings(deadline=None, max_examples=60)
@given(SEEDS, st.sampled_from(TURNS))
def test_mirrors_and_turns_by_axes(seed, turn):
    problem = random_problem(seed)
    turned = replace(
        problem,
        position=turn @ problem.position,
        desired=turn @ problem.desired,
        centres=problem.centres @ turn.T,
        velocities=problem.velocities @ turn.T,
    )
    assert_alike(solve(problem), solve(turned), turn)


@settings(deadline=None, max_examples=60)
@given(SEEDS, st.tuples(*[st.floats(-5, 5)] * 3))
def test_a_shift_of_the_origin(seed, shift):
    problem = random_problem(seed)
    by = np.array(shift)
    moved = replace(problem, position=problem.position + by, centres=problem.centres + by)
    assert_alike(solve(problem), solve(moved))


@settings(deadline=None, max_examples=60)
@given(SEEDS, st.integers(0, 6))
def test_an_obstacle_far_away_changes_not_one_bit(seed, place):
    problem = random_problem(seed)
    place = min(place, len(problem.radii))
    more = ControlProblem(
        problem.position,
        problem.desired,
        np.insert(problem.centres, place, problem.position + np.array([30.0, -20.0, 10.0]), axis=0),
        np.insert(problem.radii, place, 0.4),
        np.insert(problem.velocities, place, (0.1, 0.0, 0.0), axis=0),
        np.insert(problem.sigmas, place, 0.01),
    )
    assert solve(problem).plan.tobytes() == solve(more).plan.tobytes()


@settings(deadline=None, max_examples=60)
@given(SEEDS)
def test_the_shortcut_is_the_full_solve(seed):
    problem = random_problem(seed)
    solution = solve(problem)
    assume(solution.status is Status.SHORTCUT)
    n, stages = len(problem.radii), SETTINGS.horizon + 1
    spheres = np.zeros((n, kernel.FLAT + 1 - 8))
    table = np.column_stack([problem.centres, problem.radii, problem.velocities, problem.sigmas, spheres])
    plan = stream(seed, "start").uniform(-0.3, 0.3, (stages, 3)) * 0.2 + np.outer(
        unconstrained_gains(SETTINGS), problem.desired
    )
    status, _, cost, violation = kernel.descend(
        problem.position, problem.desired, table, np.arange(n), n, plan, np.zeros((n, stages - 1)),
        np.array(SETTINGS.speed_limit), kernel_parameters(SETTINGS), tracking_hessian(SETTINGS), 30,
    )  # fmt: skip
    assert status == kernel.OPTIMAL
    assert violation == 0.0
    assert np.abs(plan[:-1] - solution.plan).max() < 2e-4
    assert cost == pytest.approx(solution.cost, rel=1e-4, abs=1e-7)


@settings(deadline=None, max_examples=100)
@given(SEEDS, st.floats(-0.2, 0.3), st.floats(0, 0.2))
def test_always_a_sound_plan_and_never_a_false_optimum(seed, gap, sigma):
    """From anywhere, inside as well."""
    rng = stream(seed, "anywhere")
    n = int(rng.integers(1, 12))
    away = rng.normal(size=(n, 3))
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    radii = rng.uniform(0.02, 0.4, n)
    problem = ControlProblem(
        np.zeros(3),
        rng.uniform(-0.4, 0.4, 3),
        away * (radii + gap + rng.exponential(0.1, n))[:, None],
        radii,
        rng.uniform(-0.2, 0.2, (n, 3)),
        np.full(n, sigma),
    )
    controller = NewtonController(SETTINGS)
    for _ in range(2):
        solution = controller.solve(problem)
        assert np.all(np.isfinite(solution.plan))
        assert np.abs(solution.plan).max() <= 0.3
        assert solution.iterations <= 60
        stage = np.arange(SETTINGS.horizon + 1)[:, None] * SETTINGS.period
        path = np.vstack([np.zeros(3), 0.1 * np.cumsum(solution.plan, axis=0)])
        h = np.stack(
            [
                np.sum((path - problem.centres[j] - stage * problem.velocities[j]) ** 2, axis=1)
                - radii[j] ** 2
                for j in range(n)
            ]
        )
        if solution.status.good:
            assert not np.any((h[:, :-1] > 0) & (h[:, 1:] < sigma - 2e-5))
