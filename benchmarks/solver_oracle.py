"""The compiled solver against Ipopt on the full problem, instance by instance, each difference explained.

`python -m benchmarks.solver_oracle [--quick] [--number 2000] [--json FILE]` prints a table of classes for random
instances and for ticks of closed loops.
"""

import argparse
import json
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import casadi
import numpy as np

from benchmarks.solver_instances import SETTINGS, closed_loop, random_problems
from farhand.operator_side.control import barrier as rows
from farhand.operator_side.control.controller import ControlProblem, ControlSolution, Status
from farhand.operator_side.control.registry import make_controller
from farhand.operator_side.control.statement import parameter_values, state_problem
from farhand.operator_side.control.tracking import tracking_cost

COST_AGREES = 1e-3  # relative
VELOCITY_AGREES = 5e-3  # m/s
CLASSES = (
    "agree",
    "same plan, cost within the rows' tolerance",
    "another local optimum, cheaper",
    "another local optimum, dearer",
    "newton capped",
    "newton elastic",
    "infeasible, both",
    "infeasible, newton only",
    "ipopt converged only from newton's plan",
    "ipopt did not converge",
    "wrong",
)


@dataclass(frozen=True)
class OracleAnswer:
    """Ipopt's plan (N, 3), its cost with the best omega, and whether it converged."""

    plan: Any
    cost: float
    converged: bool


class Oracle:
    """Ipopt on the full problem, from any start."""

    def __init__(self) -> None:
        self._programs: dict[tuple[int, bool], Any] = {}

    def solve(self, problem: ControlProblem, start: Any, stay: bool = False) -> OracleAnswer:
        """From the (N, 3) plan `start`; with `stay` its barrier starts small, to stay near."""
        count = len(problem.radii)
        n = SETTINGS.horizon
        if (count, stay) not in self._programs:
            symbolic = state_problem(SETTINGS, count, condensed=False)
            options: dict[str, Any] = {"ipopt.print_level": 0, "ipopt.sb": "yes", "print_time": False}
            options["ipopt.max_wall_time"] = 4.0
            if stay:
                options |= {"ipopt.mu_init": 1e-7, "ipopt.bound_push": 1e-7, "ipopt.bound_frac": 1e-7}
            self._programs[count, stay] = symbolic, casadi.nlpsol("oracle", "ipopt", symbolic.nlp, options)
        symbolic, solver = self._programs[count, stay]
        full = np.vstack([start, start[-1:]])
        path = rows.path(problem, start, SETTINGS.period)[1:]
        answer = solver(
            x0=np.concatenate([full.ravel(), path.ravel(), np.ones(n * count)]),
            p=parameter_values(problem, count),
            lbx=symbolic.lower,
            ubx=symbolic.upper,
            lbg=symbolic.constraints_lower,
            ubg=symbolic.constraints_upper,
        )
        full = np.array(answer["x"]).ravel()[: symbolic.velocities].reshape(-1, 3)
        plan = full[:-1]
        cost = tracking_cost(full, problem.desired, SETTINGS) + rows.relaxation_cost(problem, plan, SETTINGS)
        return OracleAnswer(plan, cost, bool(solver.stats()["success"]))


def classify(oracle: Oracle, problem: ControlProblem, solution: ControlSolution) -> str:
    """One of CLASSES."""
    violation, _ = rows.worst_violation(problem, solution.plan, SETTINGS)
    if solution.status.good and violation > 2 * rows.ROW_TOLERANCE:
        return "wrong"
    limit = np.array(SETTINGS.speed_limit)
    straight = np.tile(np.clip(problem.desired, -limit, limit), (SETTINGS.horizon, 1))
    answer = oracle.solve(problem, straight)
    if solution.status is Status.INFEASIBLE:
        return "infeasible, newton only" if answer.converged else "infeasible, both"
    if answer.converged and _agree(solution, answer):
        return "agree"
    if solution.status is Status.CAPPED:
        return "newton capped"
    if solution.status is Status.ELASTIC:
        return "newton elastic"
    if answer.converged and float(np.abs(solution.plan - answer.plan).max()) <= VELOCITY_AGREES:
        return "same plan, cost within the rows' tolerance"
    # does Ipopt stay where the compiled solver ended?
    stayed = oracle.solve(problem, solution.plan, stay=True)
    if stayed.converged and float(np.abs(solution.plan - stayed.plan).max()) <= VELOCITY_AGREES:
        if not answer.converged:
            return "ipopt converged only from newton's plan"
        cheaper = solution.cost < answer.cost
        return "another local optimum, cheaper" if cheaper else "another local optimum, dearer"
    return "wrong" if stayed.converged else "ipopt did not converge"


def _agree(solution: ControlSolution, answer: OracleAnswer) -> bool:
    cost = abs(solution.cost - answer.cost) <= COST_AGREES * max(abs(answer.cost), 1e-3)
    return cost and float(np.abs(solution.plan[0] - answer.plan[0]).max()) <= VELOCITY_AGREES


def run(number: int = 2000) -> dict[str, dict[str, int]]:
    """Class counts for the random and for the closed-loop instances."""
    oracle = Oracle()
    random_classes: Counter[str] = Counter()
    for problem in random_problems(number):
        random_classes[classify(oracle, problem, make_controller(SETTINGS).solve(problem))] += 1
    loop_classes: Counter[str] = Counter()
    for problem, solution in closed_loop(number):
        loop_classes[classify(oracle, problem, solution)] += 1
    return {"random": dict(random_classes), "closed loop": dict(loop_classes)}


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description="the compiled solver against Ipopt")
    parser.add_argument("--number", type=int, default=2000, help="instances of each kind")
    parser.add_argument("--json", type=Path, help="write the counts to this file as well")
    parser.add_argument("--quick", action="store_true", help="to see that it works; the figures mean nothing")
    arguments = parser.parse_args()
    result = run(3 if arguments.quick else arguments.number)
    print(f"{'class':44}" + "".join(f"{kind:>14}" for kind in result))
    for name in CLASSES:
        print(f"{name:44}" + "".join(f"{counts.get(name, 0):>14}" for counts in result.values()))
    if arguments.json:
        arguments.json.write_text(json.dumps(result, indent=2))


if __name__ == "__main__":
    main()
