"""A robot whose fault lasts, before the automatic tester: it tries three times, then says so and leaves it alone."""

import pytest

from farhand.laboratory.simulation import simulate
from farhand.robot_side.robots.registry import make_robot
from farhand.runs.scenario import load_scenario


@pytest.mark.parametrize("network", ["none", "constant:300"])
def test_the_tester_stops_acknowledging_and_the_summary_says_why(network):
    scenario = load_scenario("point-obstacle")
    robot = make_robot(scenario)
    step, ticks = robot.step, iter(range(10**9))

    def broken(velocity, dt):
        if next(ticks) > 100:
            raise OSError("no motor")
        step(velocity, dt)

    robot.step = broken
    summary = simulate(scenario, network=network, robot=robot, time_limit=8.0).summary
    assert summary.stops == 4
    assert "robot stopped: fault: OSError: no motor" in summary.why
    assert summary.why.endswith("the tester acknowledges it no more: it came back 3 times; see to the robot")
