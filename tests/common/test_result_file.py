"""Results on disk: written whole, read back equal, and refused in one line where they cannot be read."""

import json
import os

import msgspec
import pytest

from farhand.common.errors import ResultError
from farhand.common.result_file import read_result, write_result
from farhand.netem.measure.result import Delays, DirectionResult, FlowCounts, KernelCounts, NetemResult
from farhand.operator_side.accounts.result import OperatorResult
from farhand.robot_side.result import Lateness, RobotResult

NETEM = NetemResult(
    uplink=DirectionResult(
        spec="loss:1%", received=7, dropped={"loss": 2}, robots={"r": FlowCounts(received=7)}
    ),
    rtt=Delays(count=1, mean=0.1, std=0.0, p50=0.1, p99=0.1, max=0.1),
    tc=[KernelCounts(device="eth0", direction="uplink", packets=3, dropped=1)],
)
OPERATOR = OperatorResult(finished=True, solver="newton", series=[(0.1, None, 0.0, 0.01, 0.4)])
ROBOT = RobotResult(
    ticks=1,
    stops=0,
    min_clearance=0.02,
    refused={"stale": 2},
    mode="run",
    changes=[(5, "run", "")],
    trajectory=[(0.0, 1.0, 2.0, 3.0, 0.4)],
    lateness=Lateness(p50=0.001, p99=0.002, max=0.003, realtime_priority=False),
)


@pytest.mark.parametrize("result", [NETEM, OPERATOR, ROBOT], ids=lambda result: type(result).__name__)
def test_a_result_comes_back_as_it_was_written(result, tmp_path):
    path = tmp_path / "result.json"
    write_result(result, path)
    assert read_result(path, type(result)) == result
    assert [each.name for each in tmp_path.iterdir()] == ["result.json"]
    written = json.loads(path.read_text())
    assert written["version"] == 1
    assert written["written_by"].startswith("farhand ")


def test_a_link_stays_a_link_and_a_pipe_a_pipe(tmp_path):
    (tmp_path / "there").mkdir()
    link, target = tmp_path / "link.json", tmp_path / "there" / "robot.json"
    link.symlink_to(target)
    write_result(ROBOT, link)
    assert link.is_symlink()
    assert read_result(target, RobotResult) == ROBOT
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    try:
        write_result(RobotResult(min_clearance=None, ticks=1, stops=0), pipe)
        assert msgspec.json.decode(os.read(reader, 65536), type=RobotResult) == RobotResult(
            min_clearance=None, ticks=1, stops=0
        )
    finally:
        os.close(reader)
    assert pipe.is_fifo()


def test_a_file_in_a_folder_of_somebody_else_is_written_all_the_same(tmp_path, monkeypatch):
    path = tmp_path / "robot.json"
    path.write_text("old")

    def refuse(*_):
        raise PermissionError

    monkeypatch.setattr(os, "replace", refuse)
    write_result(ROBOT, path)
    assert read_result(path, RobotResult) == ROBOT


def test_no_file_is_no_result(tmp_path):
    assert read_result(tmp_path / "none.json", RobotResult) is None


def test_another_version_is_named_with_who_wrote_it(tmp_path):
    path = tmp_path / "robot.json"
    table = msgspec.to_builtins(ROBOT) | {"version": 2, "written_by": "farhand 9.0", "stops": "many"}
    path.write_text(json.dumps(table))
    with pytest.raises(ResultError) as refused:
        read_result(path, RobotResult)
    said = str(refused.value)
    assert "\n" not in said
    assert f"{path}: is of version 2, written by farhand 9.0" in said
    assert "reads version 1" in said


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("{ cut o", "malformed"),
        ("", "truncated"),
        ("[]", "object"),
        ("{}", "version"),
        ('{"version": 1, "stops": "many"}', "stops"),
        ('{"version": 1, "refused": ' + "[" * 100_000, ""),
        ('"\udcff"', ""),
    ],
)
def test_a_broken_file_is_one_line_that_names_it(text, named, tmp_path):
    path = tmp_path / "robot.json"
    path.write_bytes(text.encode("utf-8", "surrogateescape"))
    with pytest.raises(ResultError) as refused:
        read_result(path, RobotResult)
    said = str(refused.value)
    assert said.startswith(f"{path}: is not what a program left at its end")
    assert named in said
    assert "\n" not in said


def test_a_folder_is_no_file(tmp_path):
    with pytest.raises(ResultError, match="cannot be read"):
        read_result(tmp_path, RobotResult)
