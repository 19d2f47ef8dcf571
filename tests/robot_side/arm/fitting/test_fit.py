"""Capsules: around shapes whose answer is known, and around the known arms, which are fitted again."""

import numpy as np
import pinocchio as pin
import pytest

from farhand.common.seeds import stream
from farhand.robot_side.arm.capsules import read_capsules
from farhand.robot_side.arm.catalogue import ARMS, capsule_path
from farhand.robot_side.arm.fitting.arm import cut, fit_arm
from farhand.robot_side.arm.fitting.body import Body, bodies
from farhand.robot_side.arm.fitting.excess import excess
from farhand.robot_side.arm.fitting.fit import STEP, Capsule, fit
from farhand.robot_side.arm.model import model, read_known
from tests.examples import also


def test_a_capsule_of_two_balls_is_found_again():
    balls = Body(np.array([[0.1, 0.2, 0.3], [0.1, 0.5, 0.7]]), np.full(2, 0.05))
    found = fit(balls)
    assert found.radius == pytest.approx(0.05, abs=3 * STEP)
    assert np.linalg.norm(found.b - found.a) == pytest.approx(0.5, abs=1e-3)
    assert found.outside(balls) <= 0.0


def test_a_cube_is_held_by_less_than_its_ball():
    corners = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T * 0.1
    cube = Body(corners, np.zeros(8))
    found = fit(cube)
    assert found.volume < 4 / 3 * np.pi * (0.1 * 3**0.5) ** 3
    assert found.outside(cube) <= 0.0
    # It stands out farthest beyond the faces that its axis goes through.
    beyond = np.linalg.norm(found.b - found.a) / 2 + found.radius - 0.1
    assert excess(found, [], cube).max() == pytest.approx(beyond, abs=0.002)


def test_the_excess_of_a_perfect_fit_is_none():
    capsule = Capsule(np.zeros(3), np.array([0.0, 0.0, 0.3]), 0.05)
    body = Body(np.array([capsule.a, capsule.b]), np.full(2, 0.05))
    assert excess(capsule, [], body).max() < 0.002  # the body is measured as a hull of points


def test_two_halves_hold_the_whole():
    rng = stream(1, "points")
    points = rng.normal(0, 0.1, (40, 3))
    direction = np.array([0.6, 0.0, 0.8])
    lower, upper = cut(points, direction, 0.01)
    one, other = fit(lower), fit(upper)
    weights = rng.dirichlet(np.ones(40), 500)
    inside = weights @ points  # of the hull
    out = np.minimum(one.distances(inside) - one.radius, other.distances(inside) - other.radius)
    assert out.max() <= 1e-9


@pytest.mark.parametrize("name", list(ARMS))
def test_every_vertex_lies_inside_the_shipped_capsules(name):
    chain, _ = read_known(ARMS[name])
    shipped = read_capsules(capsule_path(name)).capsules
    arm = model(name)
    for link, body in bodies(chain.text).items():
        own = [Capsule(np.array(c.a), np.array(c.b), c.radius) for c in shipped if c.link == link]
        if not own:  # within the capsule of another link of the same rigid body
            assert link == "ee_link"
            own = [Capsule(c.a, c.b, c.radius) for c in arm.capsules if c.part == "wrist_3_link"]
            frames = pin.buildModelFromXML(arm.urdf).frames
            place = next(frame.placement for frame in frames if frame.name == link)
            body = Body(body.points @ place.rotation.T + place.translation, body.radii)
        depths = np.min(
            [capsule.distances(body.points) + body.radii - capsule.radius for capsule in own], axis=0
        )
        assert depths.max() <= 0.0, link


@pytest.mark.parametrize("name", [name if name == "ur5" else also(name) for name in ARMS])
def test_a_fit_gives_what_is_shipped(name):
    known = ARMS[name]
    chain, semantics = read_known(known)
    home = np.array(known.home)
    found = fit_arm(chain, known.tool_frame, semantics.never_colliding, home, stream(1, "arm fit"))
    shipped = read_capsules(capsule_path(name))
    assert found.outside <= 0.0
    assert [c.link for c in found.file.capsules] == [c.link for c in shipped.capsules]
    assert found.file.overlapping == shipped.overlapping
    for new, old in zip(found.file.capsules, shipped.capsules, strict=True):
        volumes = [Capsule(np.array(c.a), np.array(c.b), c.radius).volume for c in (new, old)]
        assert volumes[0] == pytest.approx(volumes[1], rel=0.01)
        assert new.radius == pytest.approx(old.radius, abs=0.002)
    moving = [each for each in found.links if each.link not in chain.standing and not each.covered_by]
    assert max(each.excess_max for each in moving) < 0.045
    assert max(each.excess_median for each in moving) < 0.024
