"""Closed forms and GJK against Coal, against brute force, and against what a distance must do."""

import itertools
import math

import coal
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull

from farhand.robot_side.kernel.distance import (
    BOX,
    CAPSULE,
    COLUMNS,
    MESH,
    PLANE,
    SPHERE,
    capsule_capsule,
    capsule_row,
    distance_floor,
    nearest_row,
)
from tests.examples import tries

KINDS = (SPHERE, CAPSULE, BOX, PLANE, MESH)
_places = st.tuples(*[st.floats(-0.6, 0.6)] * 3)
_sizes = st.floats(0.02, 0.3)


def _rotation(rng: np.random.Generator) -> np.ndarray:
    q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return q * np.sign(np.linalg.det(q))


class Shape:
    """One obstacle row, its vertices, and the same for Coal."""

    def __init__(self, kind: int, rng: np.random.Generator) -> None:
        self.kind = kind
        self.position, self.R = rng.uniform(-0.3, 0.3, 3), _rotation(rng)
        self.vertices = np.zeros((0, 3))
        size = rng.uniform(0.03, 0.3, 3)
        bounding = math.inf
        if kind == SPHERE:
            size[1:] = 0.0
            self.geometry, bounding = coal.Sphere(size[0]), size[0]
        elif kind == CAPSULE:
            size[2] = 0.0
            self.geometry, bounding = coal.Capsule(size[0], 2 * size[1]), size[0] + size[1]
        elif kind == BOX:
            self.geometry, bounding = coal.Box(*(2 * size)), float(np.linalg.norm(size))
        elif kind == PLANE:
            size[:] = 0.0
            self.geometry = coal.Halfspace(np.array([0.0, 0.0, 1.0]), 0.0)
        else:
            points = rng.normal(size=(int(rng.integers(6, 40)), 3)) * size
            self.vertices = points[ConvexHull(points).vertices]
            hull = coal.BVHModelOBBRSS()
            hull.beginModel(len(points), len(self.vertices))
            hull.addVertices(self.vertices)
            hull.endModel()
            hull.buildConvexHull(True, "Qt")
            self.geometry = hull.convex
            size[:] = 0.0, len(self.vertices), 0.0
            bounding = float(np.linalg.norm(self.vertices, axis=1).max())
        self.row = np.zeros(COLUMNS)
        self.row[0], self.row[1:4], self.row[4:13], self.row[13:16] = (
            kind,
            self.position,
            self.R.ravel(),
            size,
        )
        self.row[20] = bounding

    def coal_distance(self, a: np.ndarray, b: np.ndarray, radius: float) -> float:
        axis, middle = b - a, (a + b) / 2
        length = float(np.linalg.norm(axis))
        R = np.eye(3)
        if length > 1e-9:
            z = axis / length
            x = np.linalg.svd(z[None])[2][1]
            R = np.column_stack([x, np.cross(z, x), z])
        capsule = coal.Capsule(radius, length) if length > 1e-9 else coal.Sphere(radius)
        request, result = coal.DistanceRequest(), coal.DistanceResult()
        request.gjk_tolerance = request.epa_tolerance = 1e-9
        request.gjk_max_iterations = request.epa_max_iterations = 1000
        coal.distance(
            capsule,
            coal.Transform3s(R, middle),
            self.geometry,
            coal.Transform3s(self.R, self.position),
            request,
            result,
        )
        return result.min_distance


@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=150, deadline=None, derandomize=True)
@given(seed=st.integers(0, 2**32 - 1), a=_places, b=_places, radius=_sizes)
def test_outside_it_is_coals_distance(kind, seed, a, b, radius):
    shape, a, b = Shape(kind, np.random.default_rng(seed)), np.array(a), np.array(b)
    d, t, *n = capsule_row(a, b, radius, shape.row, shape.vertices)
    expected = shape.coal_distance(a, b, radius)
    assert d == pytest.approx(expected, abs=2e-6) or (d + radius <= 1e-9 and expected <= -radius + 1e-6)
    assert 0.0 <= t <= 1.0
    assert np.linalg.norm(n) == pytest.approx(1.0, abs=1e-9)
    assert distance_floor(a, b, radius, shape.row) <= d + 1e-9


@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=100, deadline=None, derandomize=True)
@given(seed=st.integers(0, 2**32 - 1), a=_places, b=_places)
def test_moved_along_the_normal_by_the_depth_it_just_touches(kind, seed, a, b):
    """Inside as well: the way out leads out, and no way out is shorter."""
    rng = np.random.default_rng(seed)
    shape, a, b = Shape(kind, rng), np.array(a), np.array(b)
    d, _, *n = capsule_row(a, b, 0.0, shape.row, shape.vertices)
    if d > 0.0:
        return
    touching, *_ = capsule_row(
        a - (d - 1e-4) * np.array(n), b - (d - 1e-4) * np.array(n), 0.0, shape.row, shape.vertices
    )
    assert touching == pytest.approx(1e-4, abs=2e-6)
    for way in rng.normal(size=(30, 3)):
        way *= 0.98 * -d / np.linalg.norm(way)
        assert capsule_row(a + way, b + way, 0.0, shape.row, shape.vertices)[0] <= 1e-7


@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=100, deadline=None, derandomize=True)
@given(seed=st.integers(0, 2**32 - 1), a=_places, b=_places, radius=_sizes)
def test_the_normal_says_how_the_distance_changes(kind, seed, a, b, radius):
    """Where it shifts it is never nearer than the first-order estimate, and nowhere farther, turns included."""
    rng = np.random.default_rng(seed)
    shape, a, b = Shape(kind, rng), np.array(a), np.array(b)
    d, t, *n = capsule_row(a, b, radius, shape.row, shape.vertices)
    if d < -radius + 1e-3:
        return  # inside the axis's own reach the distance is not convex
    shift, turn = rng.normal(size=(2, 3)) * 0.05
    moved, *_ = capsule_row(a + shift, b + shift, radius, shape.row, shape.vertices)
    assert moved >= d + np.dot(n, shift) - 2e-6
    turned, *_ = capsule_row(a, b + 1e-5 * turn, radius, shape.row, shape.vertices)
    assert turned <= d + np.dot(n, t * 1e-5 * turn) + 1e-8


@tries(70, of=200, derandomize=True)
@given(ends=st.tuples(*[_places] * 4), radius=_sizes, other=_sizes)
def test_two_capsules_against_brute_force(ends, radius, other):
    a, b, c, e = (np.array(x) for x in ends)
    d, t, s, *n = capsule_capsule(a, b, radius, c, e, other)
    grid = np.linspace(0, 1, 41)
    brute = min(
        float(np.linalg.norm(a + x * (b - a) - c - y * (e - c))) for x, y in itertools.product(grid, grid)
    )
    reach = 0.5 / 40 * (np.linalg.norm(b - a) + np.linalg.norm(e - c))
    assert (
        brute - reach - 1e-9 <= d + radius + other <= brute + 1e-8
    )  # axes that are all but parallel cost nm
    apart = a + t * (b - a) - c - s * (e - c)
    assert np.linalg.norm(apart) == pytest.approx(d + radius + other, abs=1e-9)
    assert np.dot(apart, n) == pytest.approx(d + radius + other, abs=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_the_worst_places_still_have_a_way_out(kind):
    """The capsule's axis through the middle, along the obstacle's own axes, and as a point there."""
    shape = Shape(kind, np.random.default_rng(4))
    for axis, length in itertools.product(range(3), (0.0, 0.1, 2.0)):
        u = shape.R[:, axis] * length
        d, t, *n = capsule_row(shape.position - u, shape.position + u, 0.05, shape.row, shape.vertices)
        assert np.isfinite([d, t, *n]).all()
        assert d <= 1e-9
        assert np.linalg.norm(n) == pytest.approx(1.0)


def test_the_nearest_of_many_rows():
    rng = np.random.default_rng(2)
    shapes = [Shape(kind, rng) for kind in (SPHERE, CAPSULE, BOX, SPHERE)]
    rows = np.array([shape.row for shape in shapes])
    a, b = np.array([0.5, 0.5, 0.5]), np.array([0.6, 0.2, 0.5])
    every = [capsule_row(a, b, 0.03, row, np.zeros((0, 3)))[0] for row in rows]
    assert nearest_row(a, b, 0.03, rows, np.zeros((0, 3))) == (min(every), int(np.argmin(every)))
    assert nearest_row(a, b, 0.03, rows[:0], np.zeros((0, 3))) == (1e6, -1)
