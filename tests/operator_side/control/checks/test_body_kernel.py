"""The check of the body where numba is missing, and what the pruning leaves out."""

import importlib.util
import sys

import numpy as np
import pytest

from farhand.operator_side.control.checks import body, body_kernel
from farhand.testing import problem

DT = 0.1


@pytest.fixture
def plain(monkeypatch):
    """The kernel as plain Python."""
    monkeypatch.setitem(sys.modules, "numba", None)
    spec = importlib.util.spec_from_file_location("plain_body_kernel", body_kernel.__file__)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def drawn(seed):
    """A random check: z, the body's velocity, a plan, obstacles, lag and period."""
    draw = np.random.default_rng(seed)
    n, fast, moving = (
        int(draw.integers(0, 9)),
        float(draw.choice([0.3, 1.0, 2.0])),
        float(draw.choice([0.0, 0.3])),
    )
    plan = draw.normal(size=(1, 3)) * fast + draw.normal(size=(10, 3)) * 0.2
    centres, velocities = draw.normal(size=(n, 3)), draw.normal(size=(n, 3)) * moving
    obstacles = centres, velocities, draw.uniform(0.1, 0.7, n), draw.uniform(0.0, 0.05, n)
    motion = float(draw.choice([0.01, 0.1, 0.5, 1.0])), DT
    return draw.normal(size=3) * 0.3, draw.normal(size=3) * fast, plan, obstacles, motion


def test_without_numba_the_same_code_decides_the_same(plain):
    assert not hasattr(plain.clear_steps, "py_func")
    found = [(plain.clear_steps(*drawn(seed)), body_kernel.clear_steps(*drawn(seed))) for seed in range(300)]
    assert [a for a, _ in found] == [b for _, b in found]
    assert len({a for a, _ in found}) > 5  # they are not all alike


def test_no_obstacle_that_is_too_far_to_be_looked_at_could_cut_a_plan(monkeypatch, plain):
    def all_of_them(z, first, plan, obstacles, motion, near):
        near[:] = np.arange(len(near))
        return len(near)

    pruned = [plain.clear_steps(*drawn(seed)) for seed in range(300)]
    monkeypatch.setattr(plain, "within_reach", all_of_them)
    assert pruned == [plain.clear_steps(*drawn(seed)) for seed in range(300)]


def test_nothing_is_compiled_in_a_run():
    body.prepare()
    compiled = len(body_kernel.clear_steps.signatures)
    given = problem(position=(0.0, 0.6, 0.0), centres=[[0, 0, 0]], radii=[0.5])
    plan = np.asfortranarray(np.full((5, 3), 0.1, dtype=np.float32))
    plan.setflags(write=False)
    assert body.clear_steps(given, np.array([0.5]), plan, (np.zeros(3), 1, DT)) == 5
    assert len(body_kernel.clear_steps.signatures) == compiled == 1


def test_a_plan_of_another_shape_is_refused():
    given = problem(centres=[[0, 0, 0]], radii=[0.5])
    with pytest.raises(ValueError, match=r"a plan is \(N, 3\)"):
        body.clear_steps(given, np.array([0.5]), np.zeros((4, 2)), (np.zeros(3), 1.0, DT))
