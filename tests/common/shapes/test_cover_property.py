"""The spheres that the controller sees cover all of a shape, and leave it by 20 mm at most."""

import numpy as np
import pytest
from hypothesis import given

from farhand.common.shapes.box import Box
from farhand.common.shapes.capsule import Capsule
from farhand.common.shapes.cover import EXCESS, MOST_SPHERES, closely_covered, cover, covers, plane_of
from farhand.common.shapes.obstacle import Obstacle
from farhand.common.shapes.plane import Plane
from farhand.common.shapes.sphere import Sphere
from tests.common.shapes.shape_strategies import DIRECTIONS_FEW, make_mesh, solids
from tests.examples import tries


def uncovered(shape, centres, radii) -> float:
    """How far the worst of many points of the shape, most of them on its surface, lies outside all spheres (m)."""
    rng = np.random.default_rng(7)
    reach = shape.bounding_radius
    places = np.vstack([rng.uniform(-reach, reach, (300, 3)), 3.0 * reach * DIRECTIONS_FEW])
    inside = [p if shape.distance(*p) <= 0.0 else shape.witness(*p) for p in places]
    gaps = np.linalg.norm(np.array(inside)[:, None] - centres, axis=2) - radii
    return float(gaps.min(axis=1).max())


@tries(25, of=60)
@given(solids)
def test_all_is_covered_and_nothing_by_much_more(shape):
    found = closely_covered(shape)
    if found is None:
        assert shape.bounding_radius > 0.5  # only what is large takes thousands
        return
    centres, radii = found
    assert uncovered(shape, centres, radii) <= 1e-9
    # Of a ball around c of radius R no point is farther from a convex body than R + distance(c).
    excess = max(r + shape.distance(*c) for c, r in zip(centres, radii, strict=True))
    assert excess <= EXCESS + 1e-9


@pytest.mark.parametrize(
    ("shape", "most"),
    [
        (Sphere(0.07), 1),
        (Capsule(0.03, 0.2), 6),
        (Capsule(0.05, 0.5), 11),
        (Box((0.05, 0.05, 0.05)), 8),
        (Box((0.15, 0.1, 0.05)), 46),
        (Box((0.1, 0.1, 0.1)), 56),
        (Box((0.03, 0.03, 0.5)), 25),
        (Box((0.6, 0.4, 0.02)), 425),
        (make_mesh(1), 100),
    ],
)
def test_few_spheres_do(shape, most):
    assert len(cover(Obstacle("o", (0, 0, 0), shape=shape))[1]) <= most


def test_corners_and_edges_of_a_box_are_covered_to_the_last():
    half = np.array([0.15, 0.1, 0.05])
    centres, radii = cover(Obstacle("o", (0, 0, 0), shape=Box((0.15, 0.1, 0.05))))
    steps = np.linspace(-1, 1, 41)
    edges = [
        half * np.roll([t, a, b], axis) for axis in range(3) for t in steps for a in (-1, 1) for b in (-1, 1)
    ]
    gaps = np.linalg.norm(np.array(edges)[:, None] - centres, axis=2) - radii
    assert gaps.min(axis=1).max() <= 1e-12


def test_what_takes_too_many_is_one_ball_around_all():
    hall = Box((5.0, 5.0, 3.0))
    assert closely_covered(hall) is None
    centres, radii = cover(Obstacle("hall", (0, 0, 0), shape=hall))
    assert (len(radii), radii[0]) == (1, hall.bounding_radius)
    assert not centres.any()


def test_a_scene_of_large_shapes_takes_no_more_spheres_than_can_be_solved_for():
    walls = [Obstacle(f"wall-{i}", (i, 0.0, 0.0), shape=Box((1.0, 0.5, 0.2))) for i in range(9)]
    ball = Obstacle("ball", (0.0, 3.0, 0.0), shape=Sphere(0.1))
    assert sum(len(cover(wall)[1]) for wall in walls) > MOST_SPHERES
    found = covers([*walls, ball])
    assert MOST_SPHERES / 2 < sum(len(radii) for _, radii in found) <= MOST_SPHERES
    for obstacle, (centres, radii) in zip([*walls, ball], found, strict=True):
        assert uncovered(obstacle.shape, centres, radii) <= 1e-9


def test_planes_stay_planes():
    table = Obstacle("table", (0.0, 0.0, -0.1), shape=Plane())
    assert len(cover(table)[1]) == 0
    normal, point = plane_of(table)
    assert normal.tolist() == [0.0, 0.0, 1.0]
    assert point.tolist() == [0.0, 0.0, -0.1]
    assert plane_of(Obstacle("ball", (0, 0, 0), 0.1)) is None
