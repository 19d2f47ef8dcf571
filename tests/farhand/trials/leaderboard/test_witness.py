"""What is measured is true: against a way whose clearance is known, and profiles whose smoothness is."""

import math

import numpy as np
import pytest

from farhand.common.geometry import STILL
from farhand.common.link.link import Packet
from farhand.common.messages.codec import encode
from farhand.common.messages.keys import state_key
from farhand.robot_side.robots.robot import Robot, RobotSample
from farhand.runs.scenario import load_scenario, replace_settings
from farhand.testing import messages
from farhand.trials.leaderboard.judge.smoothness import spectral_arc_length
from farhand.trials.leaderboard.judge.witness import Witness
from farhand.trials.leaderboard.tasks.scenes import GAP, SCENES

DT = 0.002
MOVER = {
    "obstacles": [{"id": "m", "position": [3.0, 0.0, 3.0], "radius": 0.1, "velocity": [0.1, 0.0, 0.0]}],
    "targets": [[1.0, 0.0, 1.3]],
}


class Straight(Robot):
    """Goes along x at 1 m/s, 0.55 m below the ball of radius 0.4 m at (2.3, 0, 1.85)."""

    def __init__(self):
        self.x = 0.0

    @classmethod
    def for_scenario(cls, scenario):
        raise NotImplementedError

    def sample(self):
        return RobotSample((self.x, 0.0, 1.3), (1.0, 0.0, 0.0))

    def step(self, twist, dt, surroundings=None):
        self.x += dt


def test_depth_and_time_of_a_violation_are_those_of_geometry():
    scenario = load_scenario("point-obstacle")
    radius = scenario.robot.radius
    witness = Witness(Straight(), scenario)
    for _ in range(round(4.6 / DT)):
        witness.sample()
        witness.step(STILL, DT)
    tool = witness.seen.tool
    nearest = 0.55 - 0.4 - radius
    assert tool.nearest == pytest.approx(nearest, abs=1e-5)
    assert tool.depth == pytest.approx(0.01 - nearest, abs=1e-5)
    half = math.sqrt((0.4 + radius + 0.01) ** 2 - 0.55**2)
    assert tool.seconds == pytest.approx(2.0 * half, abs=2.5 * DT)
    assert tool.count == 1
    assert not witness.stands


@pytest.mark.parametrize(
    ("guard", "halted", "stands"), [(True, False, False), (True, True, True), (False, False, True)]
)
def test_a_stop_counts_as_one_only_where_the_guard_may_not_move_the_robot(guard, halted, stands):
    scenario = replace_settings(load_scenario("point-obstacle"), {"guard.on": guard, **MOVER})
    witness = Witness(Straight(), scenario)
    stopped = messages.state(mode="stopped", reason="no good command")
    witness.robot_sent(Packet(state_key(scenario.robot.kind), encode(stopped)))
    witness.sample()
    if halted:
        witness.halt(DT)
    else:
        witness.step(STILL, DT)
    assert [moment.stopped for moment in witness._before] == [stands]


def test_a_robot_that_gets_nowhere_stands():
    scenario = replace_settings(load_scenario("point-obstacle"), {"guard.on": False})
    witness = Witness(Straight(), scenario)
    sample = witness.sample()
    for _ in range(round(21.0 * scenario.robot.rate_hz)):
        witness._sample = sample
        witness._look(1.0 / scenario.robot.rate_hz)
    assert witness.stands


def test_smoothness_is_that_of_the_paper_for_a_minimum_jerk_reach_and_worse_for_two():
    t = np.linspace(0.0, 1.0, 101)
    reach = 30.0 * t**2 - 60.0 * t**3 + 30.0 * t**4
    one = spectral_arc_length(list(reach), 100.0)
    two = spectral_arc_length([*reach, *([0.0] * 30), *reach], 100.0)
    assert one == pytest.approx(-1.41, abs=0.03)  # Balasubramanian et al., 2015
    assert two < one - 0.5
    assert spectral_arc_length(list(3.0 * reach), 100.0) == pytest.approx(one)
    assert spectral_arc_length([0.0] * 50, 100.0) is None


@pytest.mark.parametrize("name", [name for name, scene in SCENES.items() if scene.robot == "sphere"])
def test_a_scene_is_its_seeds_alone_and_holds_what_it_promises(name):
    def draw(seed):
        rng = np.random.default_rng(seed)
        return next(found for found in (SCENES[name].draw(rng) for _ in range(200)) if found is not None)

    scenario = draw(5)
    assert scenario == draw(5)
    assert scenario != draw(6)
    assert len(scenario.targets) == 2
    if name == "passage":
        one, other = (next(o for o in scenario.obstacles if o.id == f"ball-{k}") for k in (0, 4))
        apart = math.dist(one.position, other.position) - one.shape.radius - other.shape.radius
        assert apart == pytest.approx(GAP)
    if name.startswith("movers"):
        assert {o.speed for o in scenario.obstacles if o.moves} == {float(name.removeprefix("movers-"))}


class Scripted(Robot):
    """Is where it is put."""

    def __init__(self, place):
        self.place = place

    @classmethod
    def for_scenario(cls, scenario):
        raise NotImplementedError

    def sample(self):
        return RobotSample(self.place, (0.0, 0.0, 0.0))

    def step(self, twist, dt, surroundings=None):
        pass


def test_each_thing_that_a_robot_is_too_near_to_is_a_violation_of_its_own():
    balls = [
        {"id": name, "position": [x, 0.0, 3.0], "radius": 0.1, "velocity": [0.0, 0.0, 0.001]}
        for name, x in (("left", 2.0), ("right", 2.5))
    ]
    scenario = replace_settings(load_scenario("point-obstacle"), {**MOVER, "obstacles": balls})
    within, reach = 0.005, 0.1 + scenario.robot.radius
    robot = Scripted((2.0 - reach - within, 0.0, 3.0))
    witness = Witness(robot, scenario)

    def put(x):
        robot.place = (x, 0.0, 3.0)
        witness.sample()
        witness.step(STILL, DT)

    put(2.0 - reach - within)
    put(2.0 - reach - within)
    put(2.25)  # within both
    put(2.5 + reach + within)  # of the second alone
    put(2.0 - reach - within)  # of the first again
    assert witness.seen.tool.count == 3
    assert [sorted(each.already) for each in witness.seen.encounters] == [[], ["left"], ["right"]]


def test_what_is_under_way_is_watched_until_the_robot_rests():
    scenario = load_scenario("point-obstacle")
    robot = Straight()
    witness = Witness(robot, scenario)
    assert not witness.rests()
    speeds = len(witness.seen.speeds)
    for _ in range(100):
        witness.sample()
        witness.step(STILL, DT)
    assert not witness.rests()  # it moves
    assert len(witness.seen.speeds) == speeds
    witness._robot = Scripted((0.0, 0.0, 1.3))
    for _ in range(99):
        witness.sample()
        witness.step(STILL, DT)
        assert not witness.rests()
    for _ in range(3):
        witness.sample()
        witness.step(STILL, DT)
    assert witness.rests()
