"""The trial of robots with lag: what it draws, what it runs, and what it says of it."""

import pytest

from farhand.laboratory.campaigns.jobs import Row
from farhand.trials.safety import lag, rows
from farhand.trials.safety.lag import Ranges, draw_task, jobs_for, main


def test_each_task_has_a_lag_and_a_speed_of_its_own_within_the_ranges_and_always_the_same():
    tasks = [draw_task(3, index, "point", Ranges((0.2, 0.4), (1.0, 2.0))) for index in range(5)]
    lags = [task.robot.lag for task in tasks]
    speeds = [task.controller.speed_limit for task in tasks]
    assert len(set(lags)) == len(set(speeds)) == 5
    assert all(0.2 <= each <= 0.4 for each in lags)
    assert all(1.0 <= each[0] == each[1] == each[2] <= 2.0 for each in speeds)
    assert tasks == [draw_task(3, index, "point", Ranges((0.2, 0.4), (1.0, 2.0))) for index in range(5)]
    assert tasks != [draw_task(4, index, "point", Ranges((0.2, 0.4), (1.0, 2.0))) for index in range(5)]


def test_every_job_says_what_was_drawn_for_it():
    (job,) = jobs_for(3, 1, "uniform:50,200", "box", Ranges())
    scenario = job.run.scenario
    assert scenario.robot.kind == "box"
    assert job.labels["lag"] == scenario.robot.lag
    assert job.labels["speed"] == scenario.controller.speed_limit[0]


def test_a_task_below_d_min_or_crashed_is_told_and_counts(monkeypatch, capsys):
    def run(job):
        safe, error = job.labels["task"] != 1, "" if job.labels["task"] != 2 else "ValueError: no"
        clearance = 0.02 if safe else -0.003
        return Row(
            key=job.key,
            labels=job.labels,
            seed=0,
            finished=True,
            safe=safe,
            min_clearance=clearance,
            error=error,
        )

    monkeypatch.setattr(rows, "run_job", run)
    assert main(["--tasks", "4", "--network", "none", "--workers", "0"]) == 1
    first, *rest = capsys.readouterr().out.splitlines()
    assert first.startswith("none: 2 of 4 below d_min (6.76 to 93.24 %), least -3.0 mm, 4 finished")
    assert [line.split(":")[0].strip() for line in rest] == ["task 1", "task 2"]
    monkeypatch.setattr(rows, "run_job", lambda job: Row(key=job.key, labels=job.labels, seed=0, safe=True))
    assert main(["--tasks", "2", "--network", "none", "--workers", "0"]) == 0


@pytest.mark.parametrize("robot", lag.ROBOTS)
def test_it_really_drives(robot, capsys):
    words = ["--tasks", "1", "--network", "none", "--workers", "0", "--robot", robot, "--lag", "0.5", "0.5"]
    assert main([*words, "--speed", "1.5", "1.5"]) == 0
    assert "0 of 1 below d_min" in capsys.readouterr().out
