"""`farhand summarise`: the folder decides, what cannot be read is told in one line, nothing heavy is loaded."""

import errno
import json
import subprocess
import sys
from pathlib import Path

import pytest

from farhand.cli import run
from farhand.common.process.console import page
from farhand.common.result_file import write_result
from farhand.operator_side.accounts.result import OperatorResult
from farhand.robot_side.result import RobotResult
from farhand.runs.conclude import conclude
from farhand.runs.run import Run
from farhand.runs.scenario import load_scenario

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


def test_results_in_memory_are_summarised_though_the_folder_is_full(
    folder, tmp_path_factory, monkeypatch, capsys
):
    """As the demo does it: its programs leave their results elsewhere."""
    full = tmp_path_factory.mktemp("full")
    write = Path.write_bytes

    def no_space(path, data):
        if full in path.parents:
            raise OSError(errno.ENOSPC, "No space left on device")
        return write(path, data)

    monkeypatch.setattr(Path, "write_bytes", no_space)
    scenario = load_scenario("point-obstacle")
    told = page(stderr=True)
    assert conclude(Run.over(scenario), full, told, why="", as_json=True, left_in=folder) == 0
    captured = capsys.readouterr()
    assert json.loads(captured.out)["safe"]
    assert json.loads(captured.out)["duration"] == 2.0
    said = " ".join(captured.err.split())
    for name in ("robot.json", "operator.json", "summary.json"):
        assert f"{name}: cannot be written: No space left on device" in said
    assert "Traceback" not in said
    assert "results in" not in said
    assert not (full / "summary.json").exists()


def test_what_the_recording_lacks_is_said_at_the_end(folder, capsys):
    note = "the record program ended with exit code 1: run.mcap: 7 ticks are missing: No space left on device"
    scenario = load_scenario("point-obstacle")
    conclude(Run.over(scenario), folder, page(), why="", as_json=False, note=note)
    assert note in " ".join(capsys.readouterr().out.split())
