"""How obstacles move: a pure function of time, no faster and with no more acceleration than is said."""

import math
from itertools import pairwise

import msgspec
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from farhand.common.shapes.motion import MIN_LEG, shuttle
from farhand.common.shapes.obstacle import Obstacle, moved, place
from farhand.common.shapes.sphere import Sphere

metre = st.floats(-2.0, 2.0)
paths = st.lists(st.tuples(metre, metre, metre), min_size=2, max_size=5).map(tuple)
speeds = st.floats(0.01, 1.0)
accelerations = st.floats(0.05, 5.0)
seconds = st.floats(0.0, 100.0)


def cart(**how):
    given_ = {"path": ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)), "speed": 0.5, "acceleration": 1.0}
    return Obstacle("cart", shape=Sphere(0.1), **(given_ | how))


def motion_of(path, speed, acceleration):
    assume(all(math.dist(a, b) >= MIN_LEG for a, b in pairwise(path)))
    return shuttle(path, speed, acceleration)


@settings(max_examples=200, deadline=None)
@given(paths, speeds, accelerations, seconds, st.floats(1e-4, 0.5))
def test_neither_speed_nor_acceleration_is_more_than_said(path, speed, acceleration, t, dt):
    motion = motion_of(path, speed, acceleration)
    (a, va), (b, vb) = motion.at(t), motion.at(t + dt)
    assert math.hypot(*va) <= speed + 1e-9
    assert math.dist(a, b) <= speed * dt + 1e-9
    assert math.dist(va, vb) <= acceleration * dt + 1e-6


@settings(max_examples=100, deadline=None)
@given(paths, speeds, accelerations, seconds)
def test_the_velocity_is_the_slope_of_the_position(path, speed, acceleration, t):
    motion = motion_of(path, speed, acceleration)
    dt = 1e-5
    before, after = motion.at(t)[0], motion.at(t + dt)[0]
    slope = [(y - x) / dt for x, y in zip(before, after, strict=True)]
    assert math.dist(slope, motion.at(t + dt / 2)[1]) <= acceleration * dt + 1e-6


@settings(max_examples=100, deadline=None)
@given(paths, speeds, accelerations, seconds)
def test_it_comes_back_the_way_it_went(path, speed, acceleration, t):
    motion = motion_of(path, speed, acceleration)
    assert motion.at(motion.period - t % motion.period)[0] == pytest.approx(motion.at(t)[0], abs=1e-6)
    assert motion.at(t + motion.period)[0] == pytest.approx(motion.at(t)[0], abs=1e-6)
    assert motion.at(0.0) == (path[0], (0.0, 0.0, 0.0))


@settings(max_examples=100, deadline=None)
@given(seconds, seconds)
def test_later_and_later_still_is_later(one, other):
    twice = moved(moved(cart(), one), other)
    once = moved(cart(), one + other)
    assert twice.position == pytest.approx(once.position, abs=1e-6)
    assert place(cart(), one)[0] == pytest.approx(moved(cart(), one).position, abs=1e-9)


def test_a_leg_of_known_times():
    motion = shuttle(((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)), 0.5, 1.0)
    assert motion.period == pytest.approx(
        2 * (0.5 + 1.5 + 0.5)
    )  # 0.125 m starting, 0.75 m going on, 0.125 m braking
    assert motion.at(0.5)[0][0] == pytest.approx(0.125)
    assert motion.at(1.25) == ((pytest.approx(0.5), 0.0, 0.0), (0.5, 0.0, 0.0))
    assert motion.at(2.5)[0] == pytest.approx((1.0, 0.0, 0.0))
    assert motion.at(3.75)[1][0] == pytest.approx(-0.5)


def test_what_stands_is_the_same_object_and_what_goes_straight_on_does():
    ball = Obstacle("ball", (1.0, 0.0, 0.0), 0.1)
    assert moved(ball, 5.0) is ball
    rolling = msgspec.structs.replace(ball, velocity=(0.0, 0.5, 0.0))
    assert moved(rolling, 2.0).position == (1.0, 1.0, 0.0)
    assert (ball.moves, rolling.moves, cart().moves) == (False, True, True)


@pytest.mark.parametrize(
    ("how", "said"),
    [
        ({"path": ((0.0, 0.0, 0.0),)}, "path: a shuttle needs at least two way-points, there is 1"),
        ({"path": ((0.0, 0.0, 0.0),) * 2}, "path: two way-points in a row are one"),
        ({"speed": 0.0}, "speed: a shuttle needs one above 0"),
        ({"acceleration": 0.0}, "acceleration: a shuttle stops at its way-points"),
        ({"position": (0.0, 0.5, 0.0)}, "position: follows from the path"),
        ({"velocity": (0.0, 0.5, 0.0)}, "velocity: follows from the path"),
        ({"path": (), "position": (0.0, 0.0, 0.0)}, "speed and phase are those of a shuttle"),
    ],
)
def test_what_is_no_shuttle_is_said(how, said):
    with pytest.raises(ValueError, match=said):
        cart(**how)
