"""What make runs at its end: both sides compiled, an arm and a robot without one."""

from farhand.laboratory import warm
from farhand.runs.scenario import load_scenario


def test_it_says_what_it_does_and_begins_a_task_of_each_kind(monkeypatch, capsys):
    assert {load_scenario(name).robot.kind for name in warm.SCENARIOS} == {"ur5", "point"}
    begun = []
    monkeypatch.setattr(warm, "simulate", lambda scenario, **how: begun.append((scenario, how["network"])))
    assert warm.main() == 0
    assert begun == [(name, "none") for name in warm.SCENARIOS]
    before, after = (
        capsys.readouterr().out.splitlines()
    )  # a line each: what waits for a line's end would hold it back
    assert before == "compiling solver and robots (some 80 s when the cache is empty) ..."
    assert after.startswith("compiled in ")
