"""Outlines are those of the shapes as they are seen: nothing of a shape is outside, and the outline touches it."""

import math

import matplotlib as mpl
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

mpl.use("Agg")
import matplotlib.pyplot as plt

from farhand.common.shapes.box import Box
from farhand.common.shapes.capsule import Capsule
from farhand.common.shapes.distance import witness_on
from farhand.common.shapes.obstacle import Obstacle
from farhand.common.shapes.plane import Plane
from farhand.runs.scene_drawing import draw_shapes, draw_ways, outline, seen_inside
from tests.common.shapes.shape_strategies import DIRECTIONS_FEW, obstacles

RINGS = [(0.0, "obstacle", {"color": "grey"}), (0.1, "limit", {"fill": False})]
HALF = math.sqrt(0.5)
CRATE = Obstacle("crate", (1.0, 0.0, 0.0), shape=Box((0.1, 0.2, 0.3)))


@pytest.fixture
def axes():
    made, found = plt.subplots()
    yield found
    plt.close(made)


@settings(max_examples=100, deadline=None)
@given(obstacles, st.sampled_from([(0, 1), (0, 2), (1, 2)]), st.floats(0.0, 0.1))
def test_all_of_a_shape_is_seen_inside_its_outline(obstacle, seen, grown):
    drawn = outline(obstacle, seen, grown)
    angle = np.linspace(0, 2 * np.pi, 37)
    directions = np.column_stack([np.cos(angle), np.sin(angle)])
    reach = (drawn @ directions.T).max(axis=0)
    far = np.array(obstacle.position) + 9.0 * DIRECTIONS_FEW
    surface = np.array([witness_on(obstacle, tuple(p)) for p in far])[:, list(seen)]
    assert ((surface @ directions.T).max(axis=0) + grown <= reach + 1e-3).all()


def test_a_box_is_a_rectangle_and_a_turned_one_is_wider():
    assert np.ptp(outline(CRATE, (0, 2)), axis=0) == pytest.approx([0.2, 0.6])
    turned = Obstacle("crate", (1.0, 0.0, 0.0), shape=CRATE.shape, orientation=(HALF, 0.0, HALF, 0.0))
    assert np.ptp(outline(turned, (0, 2)), axis=0) == pytest.approx([0.6, 0.2])
    assert np.ptp(outline(CRATE, (0, 2), 0.1), axis=0) == pytest.approx([0.4, 0.8])


def test_a_capsule_seen_along_its_axis_is_round():
    post = Obstacle("post", (0.0, 0.0, 0.0), shape=Capsule(0.1, 0.5))
    assert np.linalg.norm(outline(post, (0, 1)), axis=1) == pytest.approx(0.1)
    assert np.ptp(outline(post, (0, 2)), axis=0) == pytest.approx([0.2, 1.2])


def test_in_front_of_a_box_is_seen_inside_but_beside_it_and_in_it_is_not():
    places = np.array([[1.0, 0.9, 0.0], [1.5, 0.0, 0.0], [1.0, 0.25, 0.0], [1.0, 0.0, 0.0]])
    assert seen_inside(CRATE, (0, 2), places, 0.1).tolist() == [True, False, False, False]


def test_planes_are_drawn_from_the_side_and_named_where_they_cannot_be(axes):
    table = Obstacle("table", (0.0, 0.0, -0.1), shape=Plane())
    axes.plot([0, 1], [0, 1])
    axes.autoscale_view()
    before = axes.get_xlim(), axes.get_ylim()
    assert draw_shapes(axes, [table], (0, 2), RINGS) == []
    axes.autoscale_view()
    assert (axes.get_xlim(), axes.get_ylim()) == before
    body, limit = (artist.get_xy() for artist in axes.artists or axes.patches)
    assert body[:, 1].max() == pytest.approx(-0.1)
    assert limit[:, 1].max() == pytest.approx(0.0)
    assert draw_shapes(axes, [table], (0, 1), RINGS) == ["table"]


def test_every_kind_is_drawn_and_labelled_once(axes):
    post = Obstacle("post", (0.0, 0.0, 0.0), shape=Capsule(0.1, 0.5))
    ball = Obstacle("ball", (0.0, 0.0, 0.0), 0.1)
    draw_shapes(axes, [CRATE, post, ball], (0, 2), RINGS)
    assert len(axes.patches) == 6
    assert axes.get_legend_handles_labels()[1] == ["obstacle", "limit"]


def test_the_way_of_a_shuttle_is_a_line(axes):
    path = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0))
    cart = Obstacle("cart", shape=CRATE.shape, path=path, speed=0.5, acceleration=1.0)
    draw_ways(axes, [CRATE, cart], (0, 1), 2.5)
    (line,) = axes.lines
    assert (line.get_xdata()[0], line.get_xdata()[-1]) == (0.0, pytest.approx(1.0))
