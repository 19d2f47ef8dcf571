"""Who would be run over is told from who may be made to stand."""

import pytest

from farhand.common.geometry import Twist
from farhand.common.messages.scene import Obstacle
from farhand.robot_side.robots.approach import AHEAD, LOOKS, Approach
from farhand.robot_side.robots.point import PointRobot
from farhand.robot_side.scene.obstacle_field import ObstacleField
from farhand.testing import ScriptedRobot

S = 1_000_000_000
RADIUS, D_MIN = 0.05, 0.01


def comes(*obstacles, at=0.0, robot=None):
    robot = robot or PointRobot((0.0, 0.0, 0.5), 0.1)
    field, now_ns = ObstacleField(obstacles, 0), round(at * S)
    approach = Approach(robot, RADIUS, D_MIN, 10_000_000)
    assert approach.comes(field, robot.sample(), now_ns)  # it has not looked at all yet
    return [approach.comes(field, robot.sample(), now_ns) for _ in range(LOOKS)][-1]


def ball(x, speed, **more):
    return Obstacle("ball", (x, 0.0, 0.5), 0.1, velocity=(speed, 0.0, 0.0), **more)


def shuttle(*path):
    return Obstacle("shuttle", path[0], 0.1, path=path, speed=0.4, acceleration=2.0)


@pytest.mark.parametrize(
    ("obstacle", "at", "said"),
    [
        (ball(1.0, -0.5), 0.0, True),  # it is there in 1.7 s
        (ball(2.0, -0.5), 0.0, False),  # in 3.7 s
        (ball(2.0, -0.5), 2.0, True),
        (ball(1.0, 0.5), 0.0, False),  # it goes
        (ball(-1.0, 1.0), 0.0, True),
        (Obstacle("post", (0.15, 0.0, 0.5), 0.1), 0.0, False),  # it stands
        (shuttle((0.4, 0.0, 0.5), (0.6, 0.0, 0.5)), 0.0, False),  # it turns before
        (shuttle((0.6, 0.0, 0.5), (0.1, 0.0, 0.5)), 0.0, True),
    ],
)
def test_what_comes_within_the_time_ahead_is_told_from_what_does_not(obstacle, at, said):
    assert comes(obstacle, at=at) is said


@pytest.mark.parametrize("phase", range(10))
def test_nothing_slips_through_between_two_instants(phase):
    aside = RADIUS + 0.1 + D_MIN - 1e-6  # as near as it must not come, at one point of its way
    passing = Obstacle("b", (0.5 + 0.01 * phase, aside, 0.5), 0.1, velocity=(-1.0, 0.0, 0.0))
    assert AHEAD > 0.6
    assert comes(passing)


@pytest.mark.parametrize("change", ["pause", "scene"])
def test_what_was_seen_before_a_pause_or_of_another_scene_says_nothing(change):
    robot = PointRobot((0.0, 0.0, 0.5), 0.1)
    approach, empty = Approach(robot, RADIUS, D_MIN, 10_000_000), ObstacleField([ball(9.0, 0.5)], 0)
    for k in range(LOOKS):
        comes = approach.comes(empty, robot.sample(), k * 10_000_000)
    assert not comes
    later_ns = 2 * S if change == "pause" else LOOKS * 10_000_000
    field = empty if change == "pause" else ObstacleField([ball(1.0, -0.5)], later_ns)
    assert approach.comes(field, robot.sample(), later_ns)


def test_who_is_on_its_way_aside_is_not_made_to_stand():
    robot = ScriptedRobot((0.0, 0.0, 0.5))
    robot.step(Twist((0.2, 0.0, 0.0)), 0.01)
    assert comes(ball(5.0, 0.1), robot=robot)
