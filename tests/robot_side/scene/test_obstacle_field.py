"""The field's clearances and its table are those of the exact shapes, wherever they are by then."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from farhand.common.shapes.box import Box
from farhand.common.shapes.capsule import Capsule
from farhand.common.shapes.distance import distance_to
from farhand.common.shapes.obstacle import Obstacle
from farhand.common.shapes.plane import Plane
from farhand.common.shapes.pose import rotation
from farhand.robot_side.scene.obstacle_field import NOTHING_NEAR, ObstacleField
from tests.common.shapes.shape_strategies import make_mesh, obstacles, points

SECOND = 1_000_000_000
TURN = (math.sqrt(0.5), 0.0, math.sqrt(0.5), 0.0)
BALL = Obstacle("ball", (1.0, 0.0, 0.0), 0.1)
POST = Obstacle("post", (0.0, 1.0, 0.0), shape=Capsule(0.05, 0.4), orientation=TURN)
CRATE = Obstacle("crate", (0.0, 0.0, 1.0), shape=Box((0.1, 0.2, 0.3)), velocity=(0.1, 0.0, 0.0))
TABLE = Obstacle("table", (0.0, 0.0, -1.0), shape=Plane())
PART = Obstacle("part", (-1.0, 0.0, 0.0), shape=make_mesh(4))
CART = Obstacle(
    "cart", shape=Box((0.1, 0.1, 0.1)), path=((0.5, -1.0, 0.5), (0.5, 1.0, 0.5)), speed=0.3, acceleration=0.5
)
ALL = (BALL, POST, CRATE, TABLE, PART, CART)


@settings(max_examples=100, deadline=None)
@given(st.lists(obstacles, max_size=6), points, st.floats(0.0, 0.3))
def test_the_clearance_is_that_of_the_nearest_shape(several, point, radius):
    found = ObstacleField(several, 0).clearance(point, radius, 5 * SECOND)
    nearest = min((distance_to(o, point) for o in several), default=NOTHING_NEAR + radius)
    assert found == pytest.approx(nearest - radius, abs=1e-12)


@settings(max_examples=50, deadline=None)
@given(points, st.integers(0, 60 * SECOND))
def test_movers_are_where_they_are_by_then(point, now):
    field = ObstacleField(ALL, SECOND)
    assert field.clearance(point, 0.05, SECOND + now) == pytest.approx(
        min(distance_to(o, point) for o in field.at(SECOND + now)) - 0.05, abs=1e-9
    )


def test_the_table_holds_every_kind():
    field = ObstacleField(ALL, 0)
    table = field.table(0)
    assert table.ids == ("ball", "post", "crate", "table", "part", "cart")
    assert table.rows.shape == (6, 24)
    assert table.rows.flags.c_contiguous
    assert table.rows[:, 0].tolist() == [0, 1, 2, 3, 4, 2]
    assert table.rows[:, 13:16].tolist() == [
        [0.1, 0.0, 0.0], [0.05, 0.4, 0.0], [0.1, 0.2, 0.3], [0.0] * 3, [0.0, len(PART.shape.points), 0.0], [0.1] * 3,
    ]  # fmt: skip
    assert np.array_equal(table.vertices, PART.shape.points)
    assert table.rows[1, 4:13].reshape(3, 3) == pytest.approx(np.array(rotation(TURN)))
    assert table.rows[3, 20] == math.inf
    assert table.rows[5, 19] == 0.5
    assert not table.rows[:, 21:].any()


def test_only_movers_rows_change_and_it_stays_one_object():
    field = ObstacleField(ALL, 0)
    table = field.table(0)
    before = table.rows.copy()
    assert field.table(4 * SECOND) is table
    changed = (table.rows != before).any(axis=1)
    assert changed.tolist() == [False, False, True, False, False, True]
    for row, obstacle in zip(table.rows, field.at(4 * SECOND), strict=True):
        assert row[1:4] == pytest.approx(obstacle.position)
        assert row[16:19] == pytest.approx(obstacle.velocity)
    field.table(0)
    assert np.array_equal(table.rows, before)


def test_two_meshes_have_vertices_of_their_own():
    other = Obstacle("other", (1.0, 0.0, 0.0), shape=make_mesh(9))
    table = ObstacleField([PART, BALL, other], 0).table(0)
    first, count = (int(v) for v in table.rows[2, 13:15])
    assert np.array_equal(table.vertices[first : first + count], other.shape.points)
    assert first == len(PART.shape.points)
