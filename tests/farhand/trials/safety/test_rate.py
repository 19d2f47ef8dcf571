"""The trial of rates: what it runs, what it measures, and what it says of it."""

import pytest

from farhand.laboratory.campaigns.jobs import Row
from farhand.trials.safety import answering, rate
from farhand.trials.safety.answering import Answers, drive
from farhand.trials.safety.rates import with_rate


def options(*words):
    return rate._parser().parse_args(words)


def test_every_task_is_done_at_each_rate_over_every_network_with_the_same_seed():
    jobs = rate.jobs_for(options("--tasks", "2", "--no-arm", "--robot", "point"))
    assert len(jobs) == 2 * 2 * len(rate.NETWORKS)
    assert {str(job.run.network) for job in jobs} == set(rate.NETWORKS)
    slow, fast = jobs[:2]
    assert (slow.labels["rate"], fast.labels["rate"]) == ("10", "50")
    assert (slow.run.seed, slow.run.scenario.obstacles) == (fast.run.seed, fast.run.scenario.obstacles)
    assert (slow.run.scenario.operator.rate_hz, fast.run.scenario.operator.rate_hz) == (None, 50.0)
    assert slow.run.scenario.controller == fast.run.scenario.controller


def test_short_steps_keep_the_barrier_per_second():
    plain = rate.jobs_for(options("--tasks", "1", "--no-arm", "--robot", "point"))[0].run.scenario
    short = with_rate(plain, "50-short").controller
    assert (short.period, short.horizon) == (0.02, 50)
    assert (1 - short.gamma) ** 5 == pytest.approx(1 - plain.controller.gamma)
    assert short.gamma == pytest.approx(0.13, abs=0.001)


def test_the_robot_answers_sooner_at_50_hz(monkeypatch):
    monkeypatch.setattr(answering, "LENGTH", 25.0)
    slow, fast = (drive("constant:100", rate, 0.005) for rate in ("10", "50"))
    assert slow.turns == fast.turns >= 7
    assert len(slow.robots) == len(fast.robots) == slow.turns
    assert max(fast.commands) <= 0.025 + 1e-9
    assert max(slow.commands) <= 0.105 + 1e-9
    for answers in (slow, fast):
        assert answers.robots == pytest.approx([0.1 + command for command in answers.commands], abs=0.0021)


def test_what_came_too_near_or_crashed_is_told(tmp_path):
    rows = []
    for name in ("10", "50"):
        for task in range(3):
            labels = {"network": "none", "robot": "box", "task": task, "rate": name}
            near = -0.002 if (name, task) == ("50", 1) else 0.02
            rows.append(
                Row(
                    key=f"none/box/{task}/{name}",
                    labels=labels,
                    seed=0,
                    safe=near > 0.0,
                    finished=task < 2,
                    min_clearance=near,
                    duration=20.0 if name == "10" else 21.0,
                    error="ValueError: no" if (name, task) == ("10", 2) else "",
                    why="not finished within 240 s",
                )
            )
    text = rate.table(rows, {("none", "10"): Answers(2, (0.05, 0.06), (0.07, 0.08))})
    head, _, line, _, *told = text.splitlines()
    cells = dict(zip(head.strip("| ").split(" | "), line.strip("| ").split(" | "), strict=True))
    assert (cells["below d_min, 10"], cells["below d_min, 50"]) == ("1", "1")
    assert (cells["finished, 10"], cells["least (mm), 50"], cells["time, 50 : 10"]) == ("2", "-2.0", "1.050")
    assert (cells["robot after (ms), 10"], cells["robot after (ms), 50"]) == ("75, 80", "–")
    assert told == [
        "- none/box/2/10: ValueError: no",
        "- none/box/1/50: -2.0 mm",
        "- none/box/2/50: not finished within 240 s",
    ]
