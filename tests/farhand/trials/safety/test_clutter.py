"""The trial of clutter: what it poses, and what it says of it."""

import numpy as np
import pytest

from farhand.laboratory.campaigns.jobs import Row
from farhand.trials.safety import clutter, rows
from farhand.trials.safety.clutter import Arm, Reach, cell_of, centre_of, cluttered_task, main


@pytest.fixture(scope="module")
def task():
    return cluttered_task(1, 2)


def test_a_task_is_always_the_same_and_the_arm_gets_to_its_targets(task):
    assert task == cluttered_task(1, 2)
    assert 5 <= len(task.obstacles) <= 9
    reach = Reach(Arm(), task.obstacles, task.robot.radius)
    reach.spread(task.start, np.array(task.robot.joints))
    for target in task.targets:
        assert reach.is_clear(target, reach.found[cell_of(target)])


def test_what_stands_in_a_cell_makes_it_out_of_reach(task):
    cell = cell_of(task.targets[0])
    ball = type(task.obstacles[0])(id="ball", position=centre_of(cell), radius=0.05)
    reach = Reach(Arm(), [ball], task.robot.radius)
    reach.spread(task.start, np.array(task.robot.joints))
    assert cell not in reach.found
    assert len(reach.found) > 100


def test_a_run_that_is_not_safe_counts_only_where_there_is_a_guard(monkeypatch, capsys, task):
    def run(job):
        guarded = job.run.scenario.guard.on
        return Row(
            key=job.key, labels=job.labels, seed=0, finished=True, safe=guarded is not bad, duration=9.0
        )

    monkeypatch.setattr(rows, "run_job", run)
    monkeypatch.setattr(clutter, "cluttered_task", lambda seed, index: task)
    bad = False
    assert main(["--tasks", "2", "--workers", "0"]) == 0
    assert "guard off: 2 of 2 finished, 9.0 s on average, 2 not safe" in capsys.readouterr().out
    bad = True
    assert main(["--tasks", "2", "--workers", "0"]) == 1
