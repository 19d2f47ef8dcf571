"""Planes: rows of their own, the same in every solver, baseline and check."""

from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec import structs

from benchmarks.solver_instances import SETTINGS
from benchmarks.solver_oracle import Oracle, classify
from farhand.common.seeds import stream
from farhand.operator_side.control import barrier as rows
from farhand.operator_side.control.checks.fallback import harmless_steps, safe_plan
from farhand.operator_side.control.checks.recovery import eased
from farhand.operator_side.control.controller import Status
from farhand.operator_side.control.newton import NewtonController
from farhand.operator_side.control.registry import make_controller
from farhand.testing.problems import problem

KEEP = 0.06
FLOOR = (0.0, 0.0, 1.0)
EXPLAINED = (
    "agree",
    "same plan, cost within the rows' tolerance",
    "another local optimum, cheaper",
    "another local optimum, dearer",
    "newton capped",
    "ipopt converged only from newton's plan",
)
KINDS = [("mpc-cbf", "newton"), ("mpc-cbf", "sqp"), ("mpc-cbf", "ipopt"), ("one-step", "newton")]


def room(rng, spheres=2, planes=2):
    """A start outside of all, spheres and planes of any direction near it, some of them moving."""
    n = spheres + planes
    toward = rng.normal(size=(n, 3))
    toward /= np.linalg.norm(toward, axis=1, keepdims=True)
    radii = np.concatenate([rng.uniform(0.07, 0.3, spheres), np.full(planes, KEEP)])
    gaps = 0.02 + rng.exponential(0.15, n)
    normals = np.concatenate([np.zeros((spheres, 3)), -toward[spheres:]])
    return problem(
        position=(0.0, 0.0, 0.0),
        desired=rng.uniform(-0.3, 0.3, 3),
        centres=toward * (radii + gaps)[:, None],
        radii=radii,
        velocities=rng.uniform(-0.05, 0.05, (n, 3)) * (rng.random() < 0.3),
        sigma=rng.choice([0.0, 0.002]),
        normals=normals,
    )


@pytest.mark.slow
def test_newton_is_the_oracles_answer_among_planes():
    rng = stream(1, "planes", "oracle")
    oracle = Oracle()
    posed = [room(rng) for _ in range(60)]
    classes = Counter(classify(oracle, p, NewtonController(SETTINGS).solve(p)) for p in posed)
    assert sum(classes[name] for name in EXPLAINED) == len(posed)
    assert classes["agree"] >= 0.9 * len(posed)


@pytest.mark.parametrize(("kind", "solver"), KINDS)
def test_who_drives_at_a_table_comes_to_rest_above_it(kind, solver):
    chosen = structs.replace(SETTINGS, kind=kind, solver=solver)
    controller = make_controller(chosen)
    height = 0.5
    for _ in range(60):
        p = problem((0.1, 0.2, height), (0.1, 0.0, -0.3), [(5.0, 5.0, 0.0)], [KEEP], normals=[FLOOR])
        plan, reason = safe_plan(p, controller.solve(p), chosen)
        assert not reason
        height += chosen.period * plan[0, 2]
        assert height >= KEEP - 1e-4
    assert height < KEEP + 0.01
    assert plan[0, 0] > 0.05  # and still goes along it


def test_a_rising_floor_pushes_up():
    p = problem((0, 0, KEEP + 0.001), (0, 0, 0), [(0, 0, 0)], [KEEP], velocities=(0, 0, 0.1), normals=[FLOOR])
    solution = NewtonController(SETTINGS).solve(p)
    assert solution.status is Status.OPTIMAL
    assert solution.plan[0, 2] > 0.09


@pytest.mark.parametrize("depth", [0.002, 0.05, 0.2])
def test_from_below_a_margin_the_way_out_is_up(depth):
    p = problem((0, 0, KEEP - depth), (0.2, 0, -0.3), [(1, 1, 0)], [KEEP], normals=[FLOOR])
    solution = NewtonController(SETTINGS).solve(eased(p, SETTINGS))
    plan, _ = safe_plan(p, solution, SETTINGS)
    assert plan[0, 2] > 0.0
    assert harmless_steps(p, plan, SETTINGS.period, SETTINGS.gamma) == len(plan)


@settings(deadline=None, max_examples=100)
@given(st.integers(0, 2**32 - 1), st.floats(-0.03, 0.2))
def test_no_plan_that_is_sent_goes_deeper_than_it_began(seed, gap):
    rng = np.random.default_rng(seed)
    p = problem(
        (0, 0, KEEP + gap),
        rng.uniform(-0.4, 0.4, 3),
        [(0, 0, 0)],
        [KEEP],
        normals=[FLOOR],
        sigma=rng.choice([0, 0.01]),
    )
    solution = NewtonController(SETTINGS).solve(eased(p, SETTINGS) or p)
    plan, _ = safe_plan(p, solution, SETTINGS)
    heights = rows.path(p, plan, SETTINGS.period)[:, 2]
    assert heights.min() >= min(heights[0], KEEP + p.sigmas[0]) - 1e-4


@settings(deadline=None, max_examples=60)
@given(st.integers(0, 2**32 - 1))
def test_a_room_turned_round_gives_the_plan_turned_round(seed):
    """A quarter turn about z maps the speed limits onto themselves."""
    p = room(np.random.default_rng(seed))
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    turned = problem(
        turn @ p.position, turn @ p.desired, p.centres @ turn.T, p.radii, p.velocities @ turn.T, p.sigmas,
        p.normals @ turn.T,
    )  # fmt: skip
    one, other = NewtonController(SETTINGS).solve(p), NewtonController(SETTINGS).solve(turned)
    if one.status.good and other.status.good and abs(one.cost - other.cost) < 1e-6:
        assert np.abs(one.plan @ turn.T - other.plan).max() < 5e-3


def test_normals_that_are_none_are_refused():
    good = problem((0, 0, 1), centres=[(0, 0, 0)], radii=[KEEP], normals=[FLOOR])
    assert rows.input_is_good(good)
    for normal in ((0, 0, 2.0), (0, 0, 0.5), (np.nan, 0, 1)):
        bad = problem((0, 0, 1), centres=[(0, 0, 0)], radii=[KEEP], normals=[normal])
        assert not rows.input_is_good(bad)
