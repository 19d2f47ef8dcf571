"""The quadratic program: every answer is proven by its multipliers, every refusal by a certificate of daqp's."""

import daqp
import numpy as np
import pytest
from hypothesis import assume, event, example, given, settings
from hypothesis import strategies as st

from farhand.robot_side.kernel.qp import BAD_INPUT, INFEASIBLE, SLACK, SMALL, SOLVED, solve, yielding


def draw(seed, n, m, stiffness):
    """A program with rows that cross the box, some alike, some parallel to its sides."""
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(n, n)) * 10.0 ** rng.uniform(-stiffness, 1, n)
    H = root @ root.T + 1e-6 * np.eye(n)
    f = rng.normal(size=n) * 10.0 ** rng.uniform(-3, 2)
    centre, half = rng.normal(size=n), rng.uniform(0.0, 1.0, n) * (rng.random(n) > 0.1)
    A = rng.normal(size=(m, n)) * 10.0 ** rng.uniform(-2, 0, (m, 1))
    for j in range(m):
        kind = rng.random()
        if kind < 0.15:
            A[j] = np.eye(n)[rng.integers(n)] * rng.choice([-1.0, 1.0])
        elif kind < 0.3 and j:
            A[j] = A[rng.integers(j)] * rng.uniform(0.5, 2.0)
        elif kind < 0.4 and j:
            A[j] = -A[rng.integers(j)]
    b = A @ (centre + rng.uniform(-0.9, 0.9, n) * half) - rng.uniform(-0.1, 0.3, m) * np.linalg.norm(
        A, axis=1
    )
    return H, f, centre - half, centre + half, A, b


def solved(H, f, low, high, A, b):
    x, multipliers = np.empty(len(f)), np.empty(2 * len(f) + len(b))
    status, steps = solve(H, f, low, high, A, b, len(b), x, multipliers)
    return status, x, multipliers, steps


def least_slack(A, b, low, high):
    """The least common shortfall of the rows in the box (their lengths taken out)."""
    from scipy.optimize import linprog

    norms = np.linalg.norm(A, axis=1)
    n = A.shape[1]
    found = linprog(
        np.append(np.zeros(n), 1.0),
        A_ub=np.column_stack([-A / norms[:, None], -np.ones(len(b))]),
        b_ub=-b / norms,
        bounds=[*zip(low, high, strict=True), (0.0, None)],
    )
    return found.fun


SEEDS = st.integers(0, 2**32 - 1)


@settings(max_examples=300, deadline=None)
@example(5162915, 1, 0, 2.0)
@given(SEEDS, st.integers(1, 9), st.integers(0, 40), st.sampled_from([0.5, 2.0, 4.0]))
def test_every_answer_is_proven_and_every_refusal_is_right(seed, n, m, stiffness):
    H, f, low, high, A, b = draw(seed, n, m, stiffness)
    status, x, multipliers, _ = solved(H, f, low, high, A, b)
    if status == INFEASIBLE:
        event("infeasible")
        assert least_slack(A, b, low, high) > 1e-9
        return
    assert status == SOLVED
    event("solved")
    norms = np.linalg.norm(A, axis=1)
    assert np.all(x >= low)
    assert np.all(x <= high)
    assert np.all(A @ x - b >= -1e-8 * np.maximum(norms, 1.0))
    assert np.all(multipliers >= 0.0)
    slope = H @ x + f - multipliers[:n] + multipliers[n : 2 * n] - A.T @ multipliers[2 * n :]
    scale = np.abs(H).max() * max(1.0, np.abs(x).max()) + np.abs(f).max() + np.abs(multipliers).max()
    assert np.abs(slope).max() <= 1e-8 * scale
    assert np.all(multipliers[:n] * (x - low) <= 1e-8 * scale)
    assert np.all(multipliers[n : 2 * n] * (high - x) <= 1e-8 * scale)
    assert np.all(multipliers[2 * n :] * (A @ x - b) <= 1e-8 * scale)


@settings(max_examples=200, deadline=None)
@given(SEEDS, st.integers(2, 8), st.integers(0, 12))
def test_it_agrees_with_daqp(seed, n, m):
    H, f, low, high, A, b = draw(seed, n, m, 0.5)
    status, x, *_ = solved(H, f, low, high, A, b)
    assume(status == SOLVED)
    upper = np.append(high, np.full(m, 1e30))
    other, _, flag, _ = daqp.solve(H, f, A, upper, np.append(low, b), np.zeros(n + m, dtype=np.int32))
    assume(flag == 1)
    assert 0.5 * x @ H @ x + f @ x <= 0.5 * other @ H @ other + f @ other + 1e-5 * (1.0 + np.abs(f).max())


@settings(max_examples=200, deadline=None)
@given(SEEDS, st.integers(1, 8), st.integers(1, 30))
def test_where_rows_cannot_all_be_kept_the_shortfall_is_least(seed, n, m):
    rng = np.random.default_rng(seed)
    low, high = -rng.uniform(0.0, 1.0, n), rng.uniform(0.0, 1.0, n)
    A = rng.normal(size=(m, n)) * rng.uniform(0.05, 1.0, (m, 1))
    b = rng.uniform(-0.2, 1.0, m)
    x = np.empty(n)
    assert yielding(A, b, m, low, high, x)[0] == SOLVED
    assert np.all((low <= x) & (x <= high))
    # Convex and smooth: least where no coordinate's slope leads further into the box.
    slope = 2 * SMALL * x - 2 * SLACK * A.T @ np.maximum(b - A @ x, 0.0)
    inward = np.where(
        x <= low + 1e-12, np.minimum(slope, 0.0), np.where(x >= high - 1e-12, np.maximum(slope, 0.0), slope)
    )
    assert np.abs(inward).max() < 1e-7


def test_two_rows_against_each_other_are_found_out():
    A = np.array([[1.0, 0.0], [-1.0, 0.0]])
    low, high = np.full(2, -1.0), np.ones(2)
    assert solved(np.eye(2), np.zeros(2), low, high, A, np.array([0.2, 0.1]))[0] == INFEASIBLE
    assert solved(np.eye(2), np.zeros(2), low, high, A, np.array([0.2, -0.2]))[0] == SOLVED
    x = np.empty(2)
    yielding(A, np.array([0.2, 0.1]), 2, low, high, x)
    assert x == pytest.approx([0.05, 0.0], abs=1e-5)


def test_a_row_of_zeros_says_nothing_or_what_is_impossible():
    box = np.full(2, -1.0), np.ones(2)
    assert solved(np.eye(2), np.ones(2), *box, np.zeros((1, 2)), np.array([-0.1]))[0] == SOLVED
    assert solved(np.eye(2), np.ones(2), *box, np.zeros((1, 2)), np.array([0.1]))[0] == INFEASIBLE


@pytest.mark.parametrize("place", range(6))
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_nonsense_is_a_status(place, value):
    parts = list(draw(1, 4, 3, 0.5))
    parts[place] = parts[place].copy()
    parts[place].flat[0] = value
    assert solved(*parts)[0] == BAD_INPUT


def test_what_is_not_convex_or_an_empty_box_is_a_status():
    nothing = np.zeros((0, 2)), np.zeros(0)
    assert solved(np.diag([1.0, -1.0]), np.ones(2), np.zeros(2), np.ones(2), *nothing)[0] == BAD_INPUT
    assert solved(np.eye(2), np.ones(2), np.ones(2), np.zeros(2), *nothing)[0] == INFEASIBLE
