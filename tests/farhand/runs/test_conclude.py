"""`farhand summarise`: the folder decides, what cannot be read is told in one line, nothing heavy is loaded."""

import json
import subprocess
import sys

import pytest

from farhand.cli import run
from farhand.common.result_file import write_result
from farhand.operator_side.result import OperatorResult
from farhand.robot_side.result import RobotResult

HEAVY = ["zenoh", "pybullet", "pinocchio", "casadi", "numba", "daqp"]


@pytest.fixture
def folder(tmp_path):
    write_result(
        RobotResult(min_clearance=0.5, ticks=1, stops=0, trajectory=[(0.0, 0.0, 0.0, 0.0, 0.5)]),
        tmp_path / "robot.json",
    )
    write_result(OperatorResult(finished=True, solver="newton", duration=2.0), tmp_path / "operator.json")
    return tmp_path


def test_it_makes_summary_scenario_and_figure(folder, capsys):
    arguments = ["summarise", str(folder), "--scenario", "point-obstacle", "--uplink", "loss:1%", "--json"]
    assert run(arguments) == 0
    summary = json.loads(capsys.readouterr().out)
    assert summary == json.loads((folder / "summary.json").read_text())
    assert (summary["safe"], summary["duration"], summary["uplink"]) == (True, 2.0, "loss:1%")
    assert (folder / "run.png").exists()
    assert 'uplink = "loss:1%"' in (folder / "scenario.toml").read_text()


@pytest.mark.parametrize(
    ("text", "named"),
    [("{ cut o", "robot.json: is not what"), ('{"version": 7}', "robot.json: is of version 7")],
)
def test_a_result_that_cannot_be_read_is_one_line_and_exit_code_2(folder, text, named, capsys):
    (folder / "robot.json").write_text(text)
    assert run(["summarise", str(folder), "--scenario", "point-obstacle"]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert len(captured.err.splitlines()) == 1
    assert named in captured.err


def test_it_loads_neither_a_link_nor_a_solver_nor_a_robot(folder):
    code = (
        "import json, sys; from farhand.cli import run;"
        f"code = run(['summarise', {str(folder)!r}, '--scenario', 'ur5-obstacle', '--json']);"
        f"print(json.dumps([code, [m for m in {HEAVY} if m in sys.modules]]))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert json.loads(done.stdout.splitlines()[-1]) == [0, []]
