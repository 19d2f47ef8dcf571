"""What the controller sees of a scene covers the true shapes, now and along the horizon."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from farhand.common.shapes.box import Box
from farhand.common.shapes.obstacle import Obstacle, place
from farhand.common.shapes.plane import Plane
from farhand.common.shapes.pose import rotation
from farhand.common.shapes.sphere import Sphere
from farhand.operator_side.control.settings import ControllerSettings
from farhand.operator_side.sensing.seen_obstacles import SeenObstacles
from farhand.testing import messages

SETTINGS = ControllerSettings()
KEEP = 0.06
HALF = 2**-0.5
CRATE = Obstacle("crate", (0.3, 0.1, 0.2), shape=Box((0.2, 0.05, 0.1)), orientation=(HALF, 0.0, 0.0, HALF))
WALL = Obstacle("wall", (0.0, 0.6, 0.0), shape=Plane(), orientation=(HALF, HALF, 0.0, 0.0))
BALL = Obstacle("ball", (0.5, 0.0, 0.3), shape=Sphere(0.07), velocity=(0.1, -0.2, 0.0))


def seen(*obstacles):
    return SeenObstacles(messages.scene(0, *obstacles), KEEP, SETTINGS)


def test_spheres_come_first_and_each_row_knows_its_obstacle():
    rows = seen(WALL, CRATE, BALL)
    assert rows.ids[-1] == "wall"
    assert set(rows.ids[: rows.spheres]) == {"crate", "ball"}
    assert np.allclose(rows.normals[-1], [0.0, -1.0, 0.0])
    assert not rows.normals[:-1].any()
    assert seen(CRATE, BALL).normals is None


@settings(deadline=None, max_examples=50)
@given(st.integers(0, 2**32 - 1))
def test_every_point_of_a_turned_box_lies_in_a_sphere(seed):
    inside = np.random.default_rng(seed).uniform(-1, 1, (50, 3)) * np.array(CRATE.shape.half_extents)
    points = inside @ np.array(rotation(CRATE.orientation)).T + CRATE.position
    now = seen(CRATE).at(0.0)
    gaps = np.linalg.norm(points[:, None] - now.centres, axis=2) - (now.radii - KEEP)
    assert gaps.min(axis=1).max() <= 1e-9


def test_what_stands_is_the_same_whenever():
    rows = seen(CRATE, WALL)
    assert rows.at(0.0) is rows.at(3.0)


def test_what_goes_straight_is_where_it_will_be():
    later = seen(BALL).at(0.5)
    assert np.allclose(later.centres[0], [0.55, -0.1, 0.3])
    assert later.radii[0] == pytest.approx(KEEP + 0.07)


def test_what_may_accelerate_is_larger_the_farther_ahead():
    swerving = Obstacle("ball", (0.5, 0.0, 0.3), shape=Sphere(0.07), velocity=(0.1, 0, 0), acceleration=0.5)
    rows = seen(swerving)
    assert rows.at(0.2).radii[0] == pytest.approx(KEEP + 0.07 + 0.25 * 0.5**2)
    assert rows.at(0.4).radii[0] > rows.at(0.2).radii[0]


@settings(deadline=None, max_examples=100)
@given(st.floats(0.0, 20.0), st.floats(0.0, 0.5), st.floats(0.05, 0.5))
def test_a_shuttle_is_inside_its_row_all_along_the_horizon(phase, ahead, speed):
    shuttle = Obstacle(
        "cart", shape=Sphere(0.07), path=((0.4, -0.4, 0.2), (0.4, 0.4, 0.2), (0.6, 0.4, 0.3)),
        speed=speed, acceleration=1.0, phase=phase,
    )  # fmt: skip
    rows = seen(shuttle).at(ahead)
    for step in range(SETTINGS.horizon + 1):
        t = step * SETTINGS.period
        truth = np.array(place(shuttle, ahead + t)[0])
        centre = rows.centres[0] + t * rows.velocities[0]
        assert np.linalg.norm(truth - centre) + 0.07 + KEEP <= rows.radii[0] + 1e-9
