"""PyBullet's shapes are the exact shapes: distances to a ball agree, and none is told too far away."""

import numpy as np
import pybullet
import pytest

from farhand.common.shapes.box import Box
from farhand.common.shapes.capsule import Capsule
from farhand.common.shapes.distance import distance_to
from farhand.common.shapes.mesh import Mesh
from farhand.common.shapes.obstacle import Obstacle
from farhand.common.shapes.plane import Plane
from farhand.common.shapes.sphere import Sphere
from farhand.robot_side.robots.bullet_obstacles import BulletObstacles
from tests.common.shapes.shape_strategies import make_mesh, unit

RADIUS = 0.01
EXACT = 1e-5


@pytest.fixture
def world():
    client = pybullet.connect(pybullet.DIRECT)
    ball = pybullet.createCollisionShape(pybullet.GEOM_SPHERE, radius=RADIUS, physicsClientId=client)
    body = pybullet.createMultiBody(0.1, ball, physicsClientId=client)
    yield client, body
    pybullet.disconnect(physicsClientId=client)


@pytest.mark.parametrize(
    ("shape", "short"),
    [
        (Sphere(0.1), 0.0),
        (Capsule(0.05, 0.2), 0.0),
        (Box((0.3, 0.02, 0.1)), 0.0),
        (Plane(), 0.0),
        (make_mesh(3), 0.2e-3),
        (make_mesh(8), 0.2e-3),
    ],
)
def test_distances_to_a_ball(world, shape, short):
    client, body = world
    rng = np.random.default_rng(1)
    for seed in range(60):
        point = rng.uniform(-0.5, 0.5, 3).tolist()
        pybullet.resetBasePositionAndOrientation(body, point, (0, 0, 0, 1), physicsClientId=client)
        turn = tuple(unit(seed, 4).tolist())
        obstacle = Obstacle("it", tuple(rng.uniform(-0.1, 0.1, 3).tolist()), shape=shape, orientation=turn)
        field = BulletObstacles(pybullet, client, body)
        truth = distance_to(obstacle, point) - RADIUS
        found, name, _ = field.nearest([obstacle])
        assert name == "it"
        assert truth - short - EXACT <= found <= truth + EXACT


def test_moves_and_turns_with_its_obstacle(world):
    client, body = world
    field = BulletObstacles(pybullet, client, body)
    crate = Obstacle("crate", (0.5, 0.0, 0.0), shape=Box((0.1, 0.2, 0.3)), orientation=(0.5, 0.5, 0.5, 0.5))
    for x in (0.5, 0.6, 0.55):
        moved = Obstacle("crate", (x, 0.0, 0.0), shape=crate.shape, orientation=crate.orientation)
        assert field.nearest([moved])[0] == pytest.approx(distance_to(moved, (0, 0, 0)) - RADIUS, abs=EXACT)


def test_a_mesh_whose_origin_lies_outside_of_it(world):
    client, body = world
    corners = tuple((x, y, z) for x in (0.5, 0.6) for y in (-0.1, 0.1) for z in (-0.1, 0.1))
    part = Obstacle("part", (0.2, 0.0, 0.0), shape=Mesh(corners))
    found, _, _ = BulletObstacles(pybullet, client, body).nearest([part])
    assert found == pytest.approx(0.7 - RADIUS, abs=0.2e-3)


def test_what_is_not_measured_again_could_not_be_the_nearest(world):
    client, body = world
    rng = np.random.default_rng(3)
    shapes = (Sphere(0.05), Box((0.05, 0.1, 0.02)), Capsule(0.03, 0.1))
    places = rng.uniform(-1.0, 1.0, (12, 3))
    point = np.zeros(3)
    field = BulletObstacles(pybullet, client, body)
    names = set()
    for step in range(400):
        if step % 20 == 0:  # straight towards another place
            way = (rng.uniform(-1.0, 1.0, 3) - point) / 20
        point += way
        places[:2] += 0.03 * np.sin(0.1 * step)
        obstacles = [
            Obstacle(f"o{k}", tuple(place.tolist()), shape=shapes[k % 3]) for k, place in enumerate(places)
        ]
        pybullet.resetBasePositionAndOrientation(body, point.tolist(), (0, 0, 0, 1), physicsClientId=client)
        fresh = BulletObstacles(pybullet, client, body)
        found = field.nearest(obstacles, np.full(1, np.linalg.norm(way)))
        assert found == fresh.nearest(obstacles)
        fresh.remove()
        names.add(found[1])
    assert len(names) > 3
