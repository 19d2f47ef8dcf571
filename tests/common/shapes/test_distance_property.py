"""Signed distances are exact: against brute force, against a proof by the witness, and against Coal."""

import math

import coal
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from farhand.common.shapes.box import Box
from farhand.common.shapes.capsule import Capsule
from farhand.common.shapes.distance import distance_to, nearest_obstacle, witness_on
from farhand.common.shapes.mesh import Mesh
from farhand.common.shapes.obstacle import Obstacle
from farhand.common.shapes.plane import Plane
from farhand.common.shapes.pose import into, rotation
from farhand.common.shapes.sphere import Sphere
from tests.common.shapes.shape_strategies import make_mesh, obstacles, points, solids, support, turns
from tests.examples import tries

DIRECTIONS = np.random.default_rng(5).normal(size=(2000, 3))
DIRECTIONS /= np.linalg.norm(DIRECTIONS, axis=1)[:, None]


@tries(100, of=300)
@given(solids, points)
def test_no_direction_tells_a_point_farther_from_a_convex_body(shape, point):
    """The signed distance is the largest of n p - h(n) over all unit n, h being the support function."""
    found = shape.distance(*point)
    over = DIRECTIONS @ np.array(point) - support(shape, DIRECTIONS)
    assert found >= over.max() - 1e-9
    # 2000 directions lie 0.1 rad apart at most, and a body reaches 0.9 m at most: the brute force is that near
    assert found <= over.max() + 0.1 * (0.9 + math.dist(point, (0, 0, 0)))


@tries(166, of=500)
@given(solids, points)
def test_the_witness_lies_on_the_surface_and_proves_the_distance(shape, point):
    found = shape.distance(*point)
    witness = shape.witness(*point)
    assert abs(shape.distance(*witness)) < 1e-9
    assert math.dist(point, witness) == pytest.approx(abs(found), abs=1e-9)
    assume(abs(found) > 1e-6)
    outwards = (np.array(point) - witness) / found
    # No point of the body lies beyond the plane through the witness: so nothing of it is nearer.
    beyond = support(shape, outwards[None])[0] - outwards @ np.array(witness)
    assert beyond == pytest.approx(0.0, abs=1e-7)


@tries(100, of=300)
@given(obstacles, points, points)
def test_no_distance_changes_faster_than_the_point_moves(obstacle, one, other):
    change = abs(distance_to(obstacle, one) - distance_to(obstacle, other))
    assert change <= math.dist(one, other) + 1e-9


@tries(66, of=200)
@given(obstacles, points)
def test_the_pose_is_a_rigid_motion(obstacle, point):
    inside = into(rotation(obstacle.orientation), obstacle.position, point)
    assert distance_to(obstacle, point) == obstacle.shape.distance(*inside)
    witness = witness_on(obstacle, point)
    assert math.dist(witness, point) == pytest.approx(abs(distance_to(obstacle, point)), abs=1e-9)
    assert math.dist(inside, (0, 0, 0)) == pytest.approx(math.dist(point, obstacle.position), abs=1e-12)


@tries(100, of=100)
@given(solids, points)
def test_the_bounding_ball_holds_all(shape, point):
    assert shape.bounding_radius >= support(shape, DIRECTIONS).max() - 1e-9
    assert shape.bounding_radius >= math.dist(shape.witness(*point), (0, 0, 0)) - 1e-9


def in_coal(shape):
    if isinstance(shape, Sphere):
        return coal.Sphere(shape.radius)
    if isinstance(shape, Capsule):
        return coal.Capsule(shape.radius, 2 * shape.half_length)
    if isinstance(shape, Box):
        return coal.Box(*(2 * half for half in shape.half_extents))
    if isinstance(shape, Plane):
        return coal.Halfspace(np.array([0.0, 0.0, 1.0]), 0.0)
    found = coal.BVHModelOBBRSS()
    found.beginModel(len(shape.hull.corners), len(shape.vertices))
    for corners in shape.hull.corners:
        found.addTriangle(*corners)
    found.endModel()
    found.buildConvexHull(True, "Qt")
    return found.convex


@tries(66, of=200)
@given(solids | st.just(Plane()), points, turns, points, st.floats(0.001, 0.1))
def test_coal_says_the_same_of_a_ball_and_any_shape(shape, at, turn, point, radius):
    obstacle = Obstacle("o", at, shape=shape, orientation=turn)
    found = distance_to(obstacle, point) - radius
    pose = coal.Transform3s(np.array(rotation(turn)), np.array(at))
    ball = coal.Transform3s(np.eye(3), np.array(point))
    result = coal.DistanceResult()
    request = coal.DistanceRequest()
    request.gjk_tolerance = 1e-10
    theirs = coal.distance(in_coal(shape), pose, coal.Sphere(radius), ball, request, result)
    if distance_to(obstacle, point) > 1e-3:  # deeper in, Coal's depth is that of its own approximation
        assert theirs == pytest.approx(found, abs=1e-5)
    else:
        assert theirs < 1e-3


def test_a_plane_is_solid_below():
    wall = Obstacle(
        "wall", (0.5, 0.0, 0.0), shape=Plane(), orientation=(math.sqrt(0.5), 0, -math.sqrt(0.5), 0)
    )
    assert distance_to(wall, (0.2, 7.0, 3.0)) == pytest.approx(0.3)
    assert distance_to(wall, (9.5, 7.0, 3.0)) == pytest.approx(-9.0)
    assert witness_on(wall, (0.2, 7.0, 3.0)) == pytest.approx((0.5, 7.0, 3.0))


def test_at_the_very_middle_there_is_a_witness_too():
    for shape in (Sphere(0.1), Capsule(0.1, 0.2), Box((0.3, 0.2, 0.1)), make_mesh(3)):
        witness = shape.witness(0.0, 0.0, 0.0)
        assert math.dist(witness, (0, 0, 0)) == pytest.approx(-shape.distance(0.0, 0.0, 0.0))


def test_the_nearest_of_several_and_of_none():
    near, far = Obstacle("near", (1.0, 0, 0), 0.1), Obstacle("far", (3.0, 0, 0), shape=Box((1.0, 1.0, 1.0)))
    assert nearest_obstacle([far, near], (0.0, 0.0, 0.0)) == (pytest.approx(0.9), "near")
    assert nearest_obstacle([], (0.0, 0.0, 0.0)) == (math.inf, "")


def test_inner_points_of_a_mesh_change_nothing():
    corners = tuple((x, y, z) for x in (-0.1, 0.1) for y in (-0.2, 0.2) for z in (-0.3, 0.3))
    mesh, box = Mesh((*corners, (0.0, 0.0, 0.0))), Box((0.1, 0.2, 0.3))
    assert len(mesh.points) == 8
    for point in np.random.default_rng(0).uniform(-0.6, 0.6, (200, 3)):
        assert mesh.distance(*point) == pytest.approx(box.distance(*point), abs=1e-12)
