"""The trial of dense fields: what it draws, and what it says of it."""

from farhand.laboratory.campaigns.jobs import Row
from farhand.trials.safety import rows
from farhand.trials.safety.dead_ends import connected, dense_task, jobs_for, main


def test_a_task_is_dense_flat_unguarded_and_always_the_same():
    task = dense_task(1, 3)
    assert 10 <= len(task.obstacles) <= 20
    assert {point[1] for point in (task.start, *task.targets)} == {0.0}
    assert not task.guard.on
    assert connected((task.start, *task.targets), task.obstacles)
    assert task == dense_task(1, 3)
    assert task != dense_task(2, 3)


def test_a_wall_divides():
    task = dense_task(1, 3)
    x, _, _ = task.start
    wall = [
        type(task.obstacles[0])(id=f"w{k}", position=(x + 0.6, 0.0, -3.0 + 0.4 * k), radius=0.3)
        for k in range(40)
    ]
    assert not connected([task.start, (x + 1.2, 0.0, 1.0)], wall)
    assert connected([task.start, (x - 0.1, 0.0, task.start[2])], [])


def test_both_ways_of_driving_are_told_and_what_came_too_near_counts(monkeypatch, capsys):
    def run(job):
        stepped = job.run.scenario.steering.own["tester"]["sidestep"]
        return Row(
            key=job.key, labels=job.labels, seed=0, finished=stepped, safe=True, min_clearance=0.02, duration=30.0
        )  # fmt: skip

    monkeypatch.setattr(rows, "run_job", run)
    assert main(["--tasks", "2", "--workers", "0"]) == 0
    straight, stepping = capsys.readouterr().out.splitlines()
    assert straight.startswith("straight on: 0 of 2 finished")
    assert stepping.startswith(
        "with side-steps: 2 of 2 finished (30.0 s in the mean), 0 below d_min, least 20.0 mm"
    )
    assert len(jobs_for(1, 2, "none", sidestep=True)) == 2
