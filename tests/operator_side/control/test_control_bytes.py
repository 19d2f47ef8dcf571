"""The same bytes from two fresh processes."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
DRIVE = """
import hashlib
from benchmarks.solver_instances import closed_loop, random_problems, SETTINGS
from farhand.operator_side.control.registry import make_controller
digest = hashlib.sha256()
for problem, solution in closed_loop(600, seed=11, counts=(5, 40)):
    digest.update(solution.plan.tobytes() + solution.status.value.encode())
controller = make_controller(SETTINGS)
for problem in random_problems(60, seed=11):
    solution = controller.solve(problem)
    facts = (solution.cost, solution.iterations, solution.binding)
    digest.update(solution.plan.tobytes() + repr(facts).encode())
print(digest.hexdigest())
"""


def test_two_fresh_processes_give_the_same_bytes():
    digests = {
        subprocess.run(
            [sys.executable, "-c", DRIVE], cwd=ROOT, check=True, capture_output=True, text=True, timeout=180
        ).stdout
        for _ in range(2)
    }
    assert len(digests) == 1
    assert len(digests.pop().strip()) == 64


@pytest.mark.slow
@pytest.mark.long
def test_a_process_that_compiles_anew_gives_the_same_bytes(tmp_path):
    """The cache changes nothing: also what a read-only install, or a new machine, computes."""
    runs = []
    for environment in (dict(os.environ), {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}):
        done = subprocess.run(
            [sys.executable, "-c", DRIVE],
            cwd=ROOT,
            check=True,
            capture_output=True,
            text=True,
            timeout=300,
            env=environment,
        )
        runs.append(done.stdout)
    assert runs[0] == runs[1]
    assert any(tmp_path.iterdir())
