"""The emulated arm goes where the simulated one goes, when both are asked for the same."""

from contextlib import closing

import numpy as np
import pytest

from farhand.common.geometry import Twist
from farhand.robot_side.arm.model import model
from farhand.runs.scenario import load_scenario, replace_settings
from farhand.trials.ur.drives import ALIKE, apart, apart_in_lockstep
from farhand.trials.ur.lockstep import LockstepUr


def test_the_distance_of_two_paths_is_that_of_their_places_from_the_others_lines():
    line = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    beside = np.array([[0.2, 0.1, 0.0], [0.5, 0.0, 0.3], [1.4, 0.0, 0.3]])
    assert apart(beside[:1], line) == pytest.approx(0.1)
    assert apart(beside, line) == pytest.approx(0.5)
    assert apart(line, line) == 0.0


@pytest.mark.parametrize("name", ["ur3e", "ur5e"])
def test_an_arm_of_the_e_series_goes_where_it_is_asked_at_500_hz(name):
    start = tuple(np.round(model(name).tool_pose(model(name).home)[1], 3).tolist())
    real = {"robot.kind": "ur", "robot.model": name, "robot.host": "127.0.0.1", "obstacles": []}
    scenario = replace_settings(
        load_scenario("ur5-obstacle"), real | {"start": start, "targets": [start], "robot.joints": None}
    )
    with closing(LockstepUr(scenario)) as arm:
        assert arm.model == name
        for _ in range(500):
            arm.step(Twist((0.0, 0.05, 0.02)), 0.002)
            went = np.array(arm.sample().position) - start
    assert went == pytest.approx([0.0, 0.05, 0.02], abs=0.002)  # in 1 s, but for what it starts later


@pytest.mark.long
@pytest.mark.slow
def test_asked_for_the_same_twists_the_paths_are_two_millimetres_apart_at_most():
    alike, _, late, _ = apart_in_lockstep("5g-urban", 500.0, seeds=(1,))
    assert 1e-5 < alike <= ALIKE
    assert 1e-5 < late < alike  # one period is less than what a controller takes
