"""The solvers against Ipopt on the full problem; benchmarks/solver_oracle.py does it on 2 x 2000."""

from collections import Counter

import numpy as np
import pytest
from msgspec import structs

from benchmarks.solver_instances import SETTINGS, closed_loop, random_problems
from benchmarks.solver_oracle import Oracle, classify
from farhand.operator_side.control.controller import Status
from farhand.operator_side.control.newton import NewtonController
from farhand.operator_side.control.sqp import SqpController
from tests.examples import THOROUGH

NUMBER = 200 if THOROUGH else 40
EXPLAINED = (
    "same plan, cost within the rows' tolerance",
    "another local optimum, cheaper",
    "another local optimum, dearer",
    "newton capped",
    "ipopt converged only from newton's plan",
)


@pytest.mark.slow
@pytest.mark.thorough
@pytest.mark.parametrize("kind", ["random", "closed loop"])
def test_newton_is_the_oracles_answer(kind):
    if kind == "random":
        ticks = ((p, NewtonController(SETTINGS).solve(p)) for p in random_problems(NUMBER, seed=2))
    else:
        ticks = closed_loop(NUMBER, seed=2, counts=(3, 10, 30, 100))
    oracle = Oracle()
    classes = Counter(classify(oracle, problem, solution) for problem, solution in ticks)
    assert classes["agree"] >= 0.97 * NUMBER
    assert classes["agree"] + sum(classes[name] for name in EXPLAINED) == NUMBER


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.thorough
def test_the_sqp_is_the_oracles_answer():
    oracle = Oracle()
    compared = 0
    for problem in random_problems(NUMBER // 2, seed=3):
        solution = SqpController(SETTINGS).solve(problem)
        if not solution.status.good:
            continue
        name = classify(oracle, problem, solution)
        assert name in ("agree", *EXPLAINED)
        compared += name == "agree"
    assert compared >= 0.85 * (NUMBER // 2)


def test_ipopt_the_controller_is_the_oracle():
    from farhand.operator_side.control.ipopt import IpoptController

    controller = IpoptController(structs.replace(SETTINGS, wall_time_limit=5.0))
    ours = NewtonController(SETTINGS)
    seen = 0
    for problem, _ in list(closed_loop(60, seed=4, counts=(3,)))[::6]:
        answer = controller.solve(problem)
        ours.reset()
        quick = ours.solve(problem)
        if (
            answer.status is Status.OPTIMAL
            and quick.status.good
            and abs(answer.cost - quick.cost) < 1e-3 * quick.cost
        ):
            assert np.abs(answer.plan[0] - quick.plan[0]).max() < 5e-3
            seen += 1
    assert seen >= 8
