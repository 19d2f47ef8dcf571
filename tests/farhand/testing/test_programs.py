"""Child processes: what they say, how they end. Small Python modules stand in for the programs."""

import os
import signal
import sys

import pytest

from farhand.runs.scenario import load_scenario
from farhand.testing import Program, Programs, short_task
from farhand.testing.programs import ask_farhand

pytestmark = pytest.mark.realtime

TALKER = """
import os, signal, sys, threading
signal.signal(signal.SIGINT, signal.default_int_handler)  # who runs these tests in the background ignores it
print("result", sys.argv[1:], os.environ.get("MOOD"))
for line in ("one", "two", "three"):
    print(line, file=sys.stderr, flush=True)
try:
    while "stay" in sys.argv:  # a signal just before a wait without end would not end it
        threading.Event().wait(0.1)
except KeyboardInterrupt:
    print("interrupted", file=sys.stderr)
    sys.exit(5)
"""


@pytest.fixture
def talker(tmp_path, monkeypatch):
    (tmp_path / "talker.py").write_text(TALKER)
    monkeypatch.setenv("PYTHONPATH", f"{tmp_path}{os.pathsep}{os.environ.get('PYTHONPATH', '')}")
    return "talker"


def test_lines_are_waited_for_in_order(talker, tmp_path):
    with Program(tmp_path, 3, module=talker, log=tmp_path / "log", environment={"MOOD": "good"}) as program:
        assert program.wait_for("two") == "two"
        assert program.said == ["one", "two"]
        with pytest.raises(AssertionError, match="ended before 'one'"):
            program.wait_for("one")
        assert program.wait() == 0
        assert program.said == ["one", "two", "three"]
    assert program.output == f"result ['{tmp_path}', '3'] good\n"
    assert (tmp_path / "log").read_text().split() == ["one", "two", "three"]


def test_what_does_not_come_in_time_is_an_assertion(talker):
    with Program("stay", module=talker) as program:
        program.wait_for("three")
        with pytest.raises(
            AssertionError, match=r"'four' did not come within 0\.01 s: \['one', 'two', 'three'\]"
        ):
            program.wait_for("four", patience=0.01)
        with pytest.raises(AssertionError, match="still runs after"):
            program.wait(patience=0.01)
        assert program.interrupt() == 5
        assert program.said[-1] == "interrupted"


def test_none_stays_whatever_goes_wrong(talker, tmp_path):
    def go_wrong(program):
        assert program.alive
        with program:
            raise ZeroDivisionError

    program = Program("stay", module=talker)
    with pytest.raises(ZeroDivisionError):
        go_wrong(program)
    assert not program.alive
    assert program.wait() == -signal.SIGKILL


def test_programs_have_logs_and_end_together(tmp_path):
    with Programs(tmp_path) as programs:
        first = programs.start("nonsense")
        second = programs.start("robot", "--scenario", "nowhere")
        assert [each.wait() for each in programs.running] == [2, 2]
        assert first.pid != second.pid
    assert sorted(path.name for path in tmp_path.iterdir()) == ["1-nonsense.log", "2-robot.log"]
    assert "nowhere" in (tmp_path / "2-robot.log").read_text()


def test_a_command_that_ends_is_asked():
    code, said = ask_farhand("simulate", "--scenario", "nowhere")
    assert code == 2
    assert said.startswith("farhand: scenario 'nowhere'")
    assert sys.executable not in said


def test_a_short_task_is_one(tmp_path):
    more = '[[obstacles]]\nid = "ball"\nposition = [0.35, 0.0, 0.43]\nradius = 0.01'
    scenario = load_scenario(str(short_task(tmp_path, targets=[(0.2, 0.0, 0.5)], more=more)))
    assert scenario.targets == ((0.2, 0.0, 0.5),)
    assert [o.id for o in scenario.obstacles] == ["ball"]
    assert load_scenario(str(short_task(tmp_path))).obstacles == ()
