"""What is printed at the end: what was lost, silent, stopped and too near is said, in 80 columns and in files."""

import io
import re

import msgspec
import pytest
from rich.console import Console

from farhand.laboratory.simulation import simulate
from farhand.netem.measure.result import Delays, DirectionResult, NetemResult
from farhand.operator_side.accounts.result import OperatorResult
from farhand.robot_side.result import Lateness, RobotResult
from farhand.runs.report import print_outcome
from farhand.runs.results import RunResults
from farhand.runs.run import Run, choose_network
from farhand.runs.scenario import load_scenario
from farhand.runs.summary import motion_start, summarise
from farhand.testing import report

POINT = load_scenario("point-obstacle")
RUN = Run(scenario=POINT, network=choose_network(POINT))


def printed(summary, width=80):
    console = Console(file=io.StringIO(), width=width)
    print_outcome(summary, None, None, console, as_json=False)
    text = console.file.getvalue()
    assert "…" not in text
    assert all(len(line) <= width for line in text.splitlines())
    return " ".join(text.split())


@pytest.fixture(scope="module")
def interrupted():
    """Two seconds without a network in the middle, and loss."""
    return simulate(POINT, uplink="constant:50 outage:at(4s,2s) loss:3%", downlink="constant:50 outage:at(4s,2s)",
                    time_limit=12.0, keep_reports=True)  # fmt: skip


def test_losses_silences_and_stops_are_in_the_summary(interrupted):
    summary, text = interrupted.summary, printed(interrupted.summary)
    up, down = summary.counts.netem.uplink.dropped, summary.counts.netem.downlink.dropped
    assert up["loss"] > 0
    assert f"loss {up['loss']}, outage {up['outage']}" in text
    assert f"(outage {down['outage']})" in text
    assert 1.9 < summary.counts.operator.longest_silence < 2.2
    assert 1.9 < summary.counts.robot.longest_silence < 2.4
    assert "s without a state at the operator" in text
    assert "s without a command at the robot" in text
    assert summary.stops == 1
    (stop,) = [i for i in summary.interruptions if i[1] == "stopped"]
    assert f"at {stop[0]:.1f} s no good command for" in text
    assert "the steering device acknowledges stops itself" in text


def test_the_silence_is_known_to_the_figure(interrupted):
    ((begin, end),) = [s for s in interrupted.silences if s[1] - s[0] > 1.0]
    assert 1.8 < end - begin < 2.6


def test_all_that_is_left_is_named_and_one_is_not_many(interrupted, tmp_path):
    (tmp_path / "run.mcap").write_bytes(b"x")
    robot = msgspec.structs.replace(interrupted.summary.counts.robot, holds=1)
    counts = msgspec.structs.replace(interrupted.summary.counts, robot=robot)
    found = msgspec.structs.replace(interrupted.summary, counts=counts, refused=1, refused_by={"old-seq": 1})
    console = Console(file=io.StringIO(), width=300)
    print_outcome(found, tmp_path, tmp_path / "run.png", console, as_json=False)
    text = console.file.getvalue()
    assert not any(line.endswith(" ") for line in text.splitlines()[1:])  # the first is a badge
    assert "(summary.json, run.png, run.mcap)" in text
    assert re.search(r"refused  1 command\n +old-seq 1: not newer than the last of its session", text)
    assert "1, 1 hold for want of commands" in text


def test_nothing_lost_is_said_as_well():
    text = printed(simulate(POINT, network="none", time_limit=1.0).summary)
    assert "up none of" in text
    assert "always with a plan" in text
    assert re.search(r"round trip 20\.0 ± 0\.0 ms with modelled computing", text)
    assert "stops 0" in text


def test_what_no_program_told_is_unknown_and_where_more_is_to_be_had_is_said(tmp_path):
    console = Console(file=io.StringIO(), width=200)
    (tmp_path / "run.mcap").write_bytes(b"x")
    found = summarise(RUN, RunResults(), real_time=True, why="interrupted")
    print_outcome(found, tmp_path, None, console, as_json=False)
    lines = [" ".join(line.split()) for line in console.file.getvalue().splitlines()]
    assert lines[0] == "SAFE OR NOT: UNKNOWN FINISHED OR NOT: UNKNOWN interrupted"
    for label in ("clearance", "stops"):
        assert f"{label} unknown: the robot left no result" in lines
    for label in ("targets", "round trip", "filter"):
        assert f"{label} unknown: the operator left no result" in lines
    assert any(line.endswith(f"report {tmp_path}") and "its recording holds more" in line for line in lines)
    assert not any(word in line for line in lines for word in ("0 of", " 0.0", "NOT SAFE", "always"))


def test_all_times_count_from_the_first_motion_command_though_the_tool_moved_later():
    robot = RobotResult(
        ticks=10,
        min_clearance=0.5,
        stops=1,
        began=2.0,
        interruptions=[(5.0, "stopped", "silence")],
        trajectory=[(0.0, 0.0, 0.0, 0.0, 1.0), (64.7, 1.0, 0.0, 0.0, 1.0)],
    )
    operator = OperatorResult(finished=True, solver="newton", duration=20.3)
    text = printed(summarise(RUN, RunResults(robot=robot, operator=operator), real_time=False))
    assert "3 in 20.3 s, counted from the first motion command as all times here" in text
    assert "at 3.0 s silence" in text


@pytest.mark.parametrize("late", [0.0, 0.3])
def test_a_machine_that_was_too_slow_is_said(late):
    netem = NetemResult(uplink=DirectionResult(error=Delays(p99=late)))
    operator = OperatorResult(finished=True, solver="newton", duration=1.0, lateness_p99=late)
    lateness = Lateness(p50=0.0, p99=late, max=late, realtime_priority=False)
    robot = RobotResult(ticks=10, min_clearance=0.5, stops=0, lateness=lateness)
    text = printed(summarise(RUN, RunResults(robot=robot, operator=operator, netem=netem), real_time=True))
    said = (
        f"this machine was too slow for {RUN.network} as it was asked for: the emulator's messages left 300 ms late, "
        "the operator's ticks began 300 ms late, the robot's loop was 300 ms late (at p99)"
    )
    assert (said in text) == bool(late)
    assert ("too slow" in text) == bool(late)


def test_a_collision_names_part_and_obstacle():
    robot = RobotResult(
        ticks=10,
        stops=0,
        min_clearance=0.0028,
        nearest_obstacle="ball",
        min_arm_clearance=-0.004,
        nearest_part="forearm_link",
        nearest_to_arm="wall",
    )
    done = OperatorResult(finished=True, solver="newton")
    text = printed(summarise(RUN, RunResults(robot=robot, operator=done), real_time=False))
    assert "NOT SAFE" in text
    assert "safety sphere came to 2.8 mm from obstacle 'ball', limit 10 mm" in text
    assert "the arm's forearm_link touched obstacle 'wall' (4.0 mm deep)" in text


def test_a_real_run_that_comes_too_near_names_the_obstacle():
    lax = msgspec.structs.replace(
        POINT,
        controller=msgspec.structs.replace(POINT.controller, kind="pass-through"),
        guard=msgspec.structs.replace(POINT.guard, on=False),
    )
    summary = simulate(lax, time_limit=12.0).summary
    assert not summary.safe
    assert repr(POINT.obstacles[0].id) in summary.too_near or "obstacle" in summary.too_near
    assert summary.nearest_obstacle in {o.id for o in POINT.obstacles}


def test_a_run_without_any_state_is_not_safe():
    summary = simulate(POINT, downlink="loss:99.9999%", time_limit=1.0).summary
    assert (summary.safe, summary.finished, summary.driven) == (False, False, False)
    text = printed(summary)
    assert text.startswith("NOTHING WAS DRIVEN")
    assert " SAFE " not in f" {text}"
    assert "no state of the robot ever arrived" in text


def test_a_run_whose_operator_saw_states_is_known():
    operator = OperatorResult(finished=False, solver="newton", last_report=report(5, states=9))
    found = summarise(
        RUN,
        RunResults(robot=RobotResult(min_clearance=0.5, ticks=1, stops=0), operator=operator),
        real_time=False,
    )
    assert (found.safe, found.driven) == (True, True)


def test_many_stops_are_counted_not_listed():
    robot = RobotResult(
        ticks=10,
        min_clearance=0.5,
        stops=9,
        interruptions=[(float(k), "stopped", f"reason {k}") for k in range(9)],
    )
    text = printed(summarise(RUN, RunResults(robot=robot), real_time=False))
    assert "reason 4" in text
    assert "reason 5" not in text
    assert "and 4 more" in text


def test_the_motion_begins_a_millimetre_from_the_start():
    assert motion_start([]) == 0.0
    rows = [(0.0, 0, 0, 0, 1), (0.5, 0, 0.0009, 0, 1), (0.6, 0, 0.002, 0, 1)]
    assert motion_start(rows) == 0.6
    assert motion_start(rows[:2]) == 0.0
