"""Six axes from the tester to the arm and back, over a network that delays."""

from itertools import pairwise

import pytest

from farhand.common.geometry import norm, turn_between
from farhand.laboratory.simulation import simulate
from farhand.runs.scenario import load_scenario, replace_setting, replace_settings


def test_the_arm_reaches_each_target_turned_as_the_tester_wants_it():
    scenario = load_scenario("ur5-turning")
    result = simulate(scenario, uplink="constant:100", downlink="constant:100", seed=1, keep_reports=True)
    summary, reports = result.summary, result.reports
    assert (summary.safe, summary.finished) == (True, True)
    wanted = scenario.steering.own["tester"]["orientations"]
    arrivals = [now for before, now in pairwise(reports) if now.target_index > before.target_index]
    away = [norm(turn_between(r.orientation, q)) for r, q in zip(arrivals, wanted, strict=True)]
    assert max(away) < 0.05
    fastest = max(norm(report.angular) for report in reports)
    assert fastest == pytest.approx(0.5)
    # Where it would be when a command takes effect was known: a round trip later it is there.
    pairs = list(zip(reports[5:], reports[8:], strict=False))
    missed = sum(norm(turn_between(was.predicted_orientation, later.orientation)) for was, later in pairs)
    turned = sum(norm(turn_between(was.orientation, later.orientation)) for was, later in pairs)
    assert missed < 0.5 * turned


def test_a_robot_without_joints_turns_as_well_and_no_faster_than_it_may():
    scenario = replace_settings(
        load_scenario("point-obstacle"),
        {
            "controller.angular_limit": 0.2,
            "steering.tester": {"orientations": [[0.0, 0.0, 0.0, 1.0]], "turn_speed": 0.5},
        },
    )
    reports = simulate(scenario, uplink="none", downlink="none", seed=1, keep_reports=True).reports
    assert max(norm(report.desired_angular) for report in reports) == pytest.approx(0.5)
    assert max(norm(report.angular) for report in reports) == pytest.approx(0.2)
    assert norm(turn_between(reports[-1].orientation, (0.0, 0.0, 0.0, 1.0))) < 0.05


def test_a_limit_that_the_robot_would_refuse_is_refused_in_one_line():
    with pytest.raises(
        Exception, match=r"controller\.angular_limit: 3 rad/s is above safety\.max_angular_speed"
    ):
        replace_setting(load_scenario("point-obstacle"), "controller.angular_limit", 3.0)


def test_an_orientation_that_is_none_is_refused_in_one_line():
    with pytest.raises(Exception, match=r"orientations\[0\] has length 2"):
        replace_setting(
            load_scenario("point-obstacle"), "steering.tester.orientations", [[2.0, 0.0, 0.0, 0.0]]
        )


def test_a_step_to_the_side_gets_past_what_is_straight_ahead():
    # Exactly on the line from start to target: the filter alone has no reason to prefer a side.
    dead_end = {
        "targets": [[3.0, 0.0, 0.6]],
        "start": [0.6, 0.0, 0.6],
        "obstacles": [{"id": "post", "position": [1.8, 0.0, 0.6], "radius": 0.3}],
    }
    scenario = replace_settings(load_scenario("point-obstacle"), dead_end)
    stuck = simulate(scenario, uplink="none", downlink="none", seed=1, time_limit=20, keep_reports=True)
    assert not stuck.summary.finished
    told = stuck.reports[-1]
    assert (told.blocked_by, told.free_side) == ("post", "left")
    assert told.held_by == "obstacle 'post'; the way round is free to the left"
    past = simulate(
        replace_setting(scenario, "steering.tester.sidestep", True),
        uplink="none", downlink="none", seed=1, time_limit=40,
    ).summary  # fmt: skip
    assert (past.safe, past.finished) == (True, True)
