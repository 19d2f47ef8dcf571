"""What could have been evaded is told from what could not, against cases whose answer is plain."""

from itertools import product

import msgspec
import numpy as np
import pytest

from farhand.common.geometry import Twist
from farhand.common.shapes.box import Box
from farhand.common.shapes.obstacle import Obstacle
from farhand.common.shapes.sphere import Sphere
from farhand.robot_side.robots.point import PointRobot
from farhand.runs.scenario import Scenario
from farhand.trials.leaderboard.judge.evasion import Encounter, Moment, Verdict, _ways, judged
from farhand.trials.leaderboard.tasks.scenes import _flight

LAG, BEGAN = 0.1, 2.0
HERE = (0.0, 0.0, 0.0)


def scene(*obstacles: Obstacle) -> Scenario:
    """The leaderboard's sphere, of radius 0.18 m, at the origin."""
    return msgspec.structs.replace(_flight("movers-0.3", [HERE, (3.0, 0.0, 0.0)], obstacles), name="evasion")


def coming(scenario: Scenario) -> Obstacle:
    """A ball whose centre comes along the x-axis and is too near at BEGAN, at 0.5 m/s."""
    away = 0.2 + scenario.robot.radius + 0.01 + 0.5 * BEGAN
    return Obstacle(id="mover", position=(away, 0.0, 0.0), velocity=(-0.5, 0.0, 0.0), shape=Sphere(0.2))


def met(*, stopped_from: float = 9.0, speed: float = 0.0) -> list[Encounter]:
    """The robot at the origin, in a latched stop from some instant on (s)."""
    moments = (Moment(t, HERE, (speed, 0.0, 0.0), t >= stopped_from) for t in np.arange(201) * 0.01)
    return [Encounter(tuple(moments))]


def test_who_stands_in_the_open_could_have_stepped_aside():
    assert judged(1, met(), scene(coming(scene()))) == Verdict(1, 0)


def test_who_stood_in_a_latched_stop_was_run_over_if_that_was_all_it_could_do():
    around = scene(coming(scene()))
    assert judged(1, met(stopped_from=0.0), around) == Verdict(0, 1)
    assert judged(1, met(stopped_from=0.4), around) == Verdict(1, 0)  # it could have gone, and stood there
    # braking is not standing: what it was about to do before the stop counts
    assert judged(1, met(stopped_from=1.9, speed=0.3), around) == Verdict(1, 0)


def test_who_has_room_for_a_step_aside_alone_could_have_taken_it():
    """A ball comes, and slabs leave 0.5 m to one side, and nothing to any other."""
    half = scene().robot.radius + 0.04
    walls = [
        Obstacle(id=f"{axis}{sign}", position=tuple(sign * (half + room + 0.05) * np.eye(3)[axis]),
                 shape=Box(tuple(np.where(np.eye(3)[axis], 0.05, 2.0))))
        for axis, sign, room in ((0, -1.0, 0.0), (1, 1.0, 0.5), (1, -1.0, 0.0), (2, 1.0, 0.0), (2, -1.0, 0.0))
    ]  # fmt: skip
    around = scene(coming(scene()), *walls)
    assert judged(1, met(), around) == Verdict(1, 0)


@pytest.mark.parametrize("shut", [True, False])
def test_who_is_shut_in_has_no_way(shut):
    """Between six slabs, 4 cm away; without the last of them there is a way."""
    half = scene().robot.radius + 0.04
    slabs = [
        Obstacle(
            id=f"slab-{axis}{sign}",
            position=tuple(sign * (half + 0.05) * np.eye(3)[axis]),
            shape=Box(tuple(np.where(np.eye(3)[axis], 0.05, 0.5))),
        )
        for axis, sign in product(range(3), (-1.0, 1.0))
    ]
    around = scene(coming(scene()), *(slabs if shut else slabs[:-1]))
    assert judged(1, met(), around) == Verdict(int(not shut), 0)


def test_what_is_not_judged_counts():
    assert judged(3, [], scene()) == Verdict(3, 0)


def test_a_way_is_that_of_the_robot():
    """Under a velocity, and then in a stop."""
    robot, wish, stop, places = PointRobot(HERE, LAG), (0.4, -0.3, 0.1), 0.5, []
    for tick in range(100):
        places.append(robot.sample().position)
        robot.step(Twist(wish if tick < 50 else HERE), 0.01)
    found = _ways(Moment(0.0, HERE, HERE, False), np.array([wish]), np.arange(100) * 0.01, stop, LAG)
    np.testing.assert_allclose(found[0], places, atol=1e-12)


def test_what_the_robot_is_too_near_to_already_does_not_excuse_the_next():
    over = Obstacle(id="over", position=(0.0, 0.2, 0.0), shape=Sphere(0.2))
    around = scene(coming(scene()), over)
    (encounter,) = met()
    assert judged(1, [encounter], around) == Verdict(0, 0)  # nothing is clear of what it is in
    assert judged(1, [Encounter(encounter.before, frozenset({"over"}))], around) == Verdict(1, 0)


def test_nobody_evades_through_what_the_robot_is_too_near_to_already():
    """A ball comes along a closed tube; in its end the robot is 5 mm too near to the wall behind it."""
    half = scene().robot.radius + 0.012
    walls = [
        Obstacle(id=f"{axis}{sign}", position=tuple(sign * (half + 0.05 - near) * np.eye(3)[axis]),
                 shape=Box(tuple(np.where(np.eye(3)[axis], 0.05, 2.0))))
        for axis, sign, near in ((0, -1.0, 0.007), (1, 1.0, 0.0), (1, -1.0, 0.0), (2, 1.0, 0.0), (2, -1.0, 0.0))
    ]  # fmt: skip
    around = scene(coming(scene()), *walls)
    (encounter,) = met()
    assert judged(1, [Encounter(encounter.before, frozenset({"0-1.0"}))], around) == Verdict(0, 0)
