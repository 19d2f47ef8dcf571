"""The summary: every counter of the programs is in it, and it says what is missing."""

import json
import typing

import msgspec
import pytest

from farhand.common.errors import ResultError
from farhand.common.result_file import write_result
from farhand.laboratory.simulation import simulate
from farhand.netem.measure.result import NetemResult
from farhand.operator_side.accounts.result import OperatorResult
from farhand.robot_side.result import RobotResult
from farhand.runs.results import RunResults, read_results
from farhand.runs.run import Run, choose_network
from farhand.runs.run_folder import summarise_results
from farhand.runs.scenario import load_scenario
from farhand.runs.summary import summarise, write_summary

POINT = load_scenario("point-obstacle")
RUN = Run(scenario=POINT, network=choose_network(POINT))
OF_THE_FILE = {"version"}  # about the file, not about the run
SETTINGS = {"seed"}  # stands in the summary already
KINDS = {"robot": RobotResult, "operator": OperatorResult, "netem": NetemResult}


ROBOT = RobotResult(min_clearance=0.5, ticks=10, stops=0)


def is_count(kind) -> bool:
    """Whether a field of this type is a number, or numbers by name."""
    members = [member for member in (typing.get_args(kind) or [kind]) if member is not type(None)]
    if typing.get_origin(kind) is dict:
        return members == [str, int]
    return all(member in (int, float) for member in members)


@pytest.mark.parametrize("part", KINDS)
def test_every_number_of_a_result_reaches_the_summary_without_a_copy_by_hand(part, tmp_path):
    kind = KINDS[part]
    counts = [
        field.name
        for field in msgspec.structs.fields(kind)
        if is_count(field.type) and field.name not in OF_THE_FILE | SETTINGS
    ]
    results = RunResults(
        robot=ROBOT, operator=OperatorResult(finished=True, solver="newton"), netem=NetemResult()
    )
    values = {
        field.name: {"x": 40 + number} if typing.get_origin(field.type) is dict else 40 + number
        for number, field in enumerate(msgspec.structs.fields(kind))
        if field.name in counts
    }
    changed = msgspec.structs.replace(getattr(results, part), **values)
    results = msgspec.structs.replace(results, **{part: changed})
    path = write_summary(summarise(RUN, results, real_time=False), tmp_path)
    written = json.loads(path.read_text())["counts"][part]
    assert {name: written.get(name) for name in counts} == values


def test_a_simulation_counts_what_its_nodes_counted():
    result = simulate(POINT, uplink="loss:10%", downlink="constant:20", seed=2, time_limit=3.0)
    counts, summary = result.summary.counts, result.summary
    assert counts.netem.uplink.dropped == result.network.uplink.dropped != {}
    assert counts.robot.stops == summary.stops
    assert (counts.operator.ticks, counts.operator.interventions) == (summary.ticks, summary.interventions)
    assert counts.operator.ticks > 20
    assert counts.robot.path_length == summary.path_length > 0.1
    assert counts.robot.lateness is None
    assert not hasattr(counts.netem.uplink, "robots")


def test_a_folder_of_dead_programs_is_not_safe_and_says_why(tmp_path):
    summary = summarise_results(RUN, read_results(tmp_path))
    assert not summary.safe
    assert not summary.finished
    assert summary.why == "the operator's program left no result"
    assert summary.counts.robot is None
    write_result(ROBOT, tmp_path / "robot.json")
    summary = summarise_results(RUN, read_results(tmp_path))
    assert summary.safe
    assert not summary.finished
    assert summary.why == "the operator's program left no result"
    assert summary.targets == len(POINT.targets)
    write_result(OperatorResult(finished=True, solver="newton"), tmp_path / "operator.json")
    assert summarise_results(RUN, read_results(tmp_path)).why == ""
    (tmp_path / "robot.json").unlink()
    summary = summarise_results(RUN, read_results(tmp_path))
    assert (summary.safe, summary.finished) == (False, True)
    assert summary.why == "the robot's program left no result"


@pytest.mark.parametrize(
    ("clearance", "arm", "safe"),
    [(None, None, False), (0.01, None, True), (0.0099, None, False), (0.5, 0.0, False), (0.5, 1e-6, True)],
)
def test_safe_means_clear_with_tool_and_arm(clearance, arm, safe):
    robot = msgspec.structs.replace(ROBOT, min_clearance=clearance, min_arm_clearance=arm)
    assert summarise(RUN, RunResults(robot=robot), real_time=False).safe is safe


def test_who_measured_nothing_is_not_safe_unless_there_is_nothing():
    idle = msgspec.structs.replace(ROBOT, ticks=0)
    assert not summarise(RUN, RunResults(robot=idle), real_time=False).safe
    free = msgspec.structs.replace(RUN, scenario=msgspec.structs.replace(POINT, obstacles=()))
    nothing = msgspec.structs.replace(ROBOT, min_clearance=None)
    assert summarise(free, RunResults(robot=nothing), real_time=False).safe


@pytest.mark.parametrize(
    "text", ['{"version": 1}', '{"version": 1, "program": "operator", "finished": true}']
)
def test_a_result_without_what_decides_or_of_another_program_is_refused(text, tmp_path):
    (tmp_path / "robot.json").write_text(text)
    with pytest.raises(ResultError, match="is not what a program left at its end"):
        read_results(tmp_path)
