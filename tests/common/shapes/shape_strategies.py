"""Shapes, places and points that hypothesis draws, and the support function of each shape, written anew."""

import numpy as np
from hypothesis import strategies as st

from farhand.common.shapes.box import Box
from farhand.common.shapes.capsule import Capsule
from farhand.common.shapes.hull import NoHullError
from farhand.common.shapes.mesh import Mesh
from farhand.common.shapes.obstacle import Obstacle
from farhand.common.shapes.sphere import Sphere

length = st.floats(0.005, 0.5)
seeds = st.integers(0, 2**32 - 1)


def make_mesh(seed: int) -> Mesh:
    """The hull of 4 to 60 points in a box of random proportions."""
    rng = np.random.default_rng(seed)
    while True:
        points = rng.uniform(-1, 1, (rng.integers(4, 60), 3)) * rng.uniform(0.02, 0.4, 3)
        try:
            return Mesh(tuple((float(x), float(y), float(z)) for x, y, z in points))
        except NoHullError:
            continue


spheres = st.builds(Sphere, length)
capsules = st.builds(Capsule, length, length)
boxes = st.builds(Box, st.tuples(length, length, length))
meshes = seeds.map(make_mesh)
solids = st.one_of(spheres, capsules, boxes, meshes)
place = st.floats(-1.0, 1.0)
points = st.tuples(place, place, place)


def unit(seed: int, size: int) -> np.ndarray:
    """A random unit vector."""
    found = np.random.default_rng(seed).normal(size=size)
    return found / np.linalg.norm(found)


turns = seeds.map(lambda seed: tuple(unit(seed, 4).tolist()))
obstacles = st.builds(
    lambda shape, at, turn: Obstacle("o", at, shape=shape, orientation=turn), solids, points, turns
)


def support(shape, directions: np.ndarray) -> np.ndarray:
    """(n,) how far a shape reaches along each of (n, 3) unit directions, own frame (m)."""
    if isinstance(shape, Sphere):
        return np.full(len(directions), shape.radius)
    if isinstance(shape, Capsule):
        return shape.radius + shape.half_length * np.abs(directions[:, 2])
    if isinstance(shape, Box):
        return np.abs(directions) @ np.array(shape.half_extents)
    return (directions @ np.array(shape.vertices).T).max(axis=1)


DIRECTIONS_FEW = np.array([unit(seed, 3) for seed in range(200)])
