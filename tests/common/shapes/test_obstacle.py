"""Obstacles in Python and on the wire: the short form of a sphere, and what is refused."""

import msgspec
import pytest
from hypothesis import given, settings

from farhand.common.messages.codec import Decoder, encode
from farhand.common.messages.scene import Scene
from farhand.common.shapes.box import Box
from farhand.common.shapes.mesh import MAX_VERTICES, Mesh
from farhand.common.shapes.obstacle import Obstacle
from farhand.common.shapes.sphere import Sphere
from farhand.testing import scene
from tests.common.shapes.shape_strategies import make_mesh, obstacles

AT = (0.1, 0.2, 0.3)


def test_the_radius_is_the_short_form_of_a_sphere():
    ball = Obstacle("ball", AT, 0.07)
    assert ball == Obstacle("ball", AT, shape=Sphere(0.07))
    assert ball.radius is msgspec.UNSET
    assert msgspec.to_builtins(ball) == {
        "id": "ball",
        "position": AT,
        "shape": {"kind": "sphere", "radius": 0.07},
    }
    assert msgspec.convert({"id": "ball", "position": AT, "radius": 0.07}, Obstacle) == ball


@settings(max_examples=100, deadline=None)
@given(obstacles)
def test_every_shape_survives_the_wire(obstacle):
    sent = scene(0, obstacle)
    assert Decoder(Scene).decode(encode(sent)) == sent


CUBE = [[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)]
FLAT = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.3, 0.3, 0.0]]


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({}, "`shape`, or the `radius` of a sphere"),
        ({"radius": 0.1, "shape": {"kind": "plane"}}, "there is a shape already"),
        ({"shape": {"kind": "cone"}}, "cone"),
        ({"shape": {"kind": "sphere", "radius": 0.0}}, "> 0.0 - at `$.shape.radius`"),
        ({"shape": {"kind": "box", "half_extents": [0.1, 0.0, 0.1]}}, "half_extents[1]"),
        ({"shape": {"kind": "capsule", "radius": 0.1}}, "half_length"),
        ({"shape": {"kind": "capsule", "radius": 0.1, "half_length": -1.0}}, "half_length"),
        ({"shape": {"kind": "mesh", "vertices": FLAT}}, "span no volume"),
        ({"shape": {"kind": "mesh", "vertices": CUBE[:3]}}, "length >= 4"),
        ({"shape": {"kind": "mesh", "vertices": CUBE * 40}}, f"length <= {MAX_VERTICES}"),
        ({"radius": 0.1, "orientation": [1.0, 1.0, 0.0, 0.0]}, "must be a unit quaternion"),
        ({"radius": 0.1, "orientation": [0.0, 0.0, 0.0, 0.0]}, "must be a unit quaternion"),
        ({"radius": 0.1, "acceleration": -1.0}, "acceleration"),
        ({"radius": 0.1, "path": [[0.0, 0.0, 0.0]], "speed": 1.0}, "way-points"),
    ],
)  # fmt: skip
def test_what_is_no_obstacle_is_refused_with_its_key(fields, said):
    with pytest.raises(msgspec.ValidationError) as found:
        msgspec.convert({"id": "o", "position": AT} | fields, Obstacle)
    assert said in str(found.value)
    assert "\n" not in str(found.value)


def test_only_a_shuttle_may_leave_its_position_out():
    with pytest.raises(msgspec.ValidationError, match="missing required field `position`"):
        msgspec.convert({"id": "o", "radius": 0.1}, Obstacle)


def test_an_obstacle_can_be_a_key():
    assert len({Obstacle("a", AT, shape=Box((1.0, 1.0, 1.0))), Obstacle("a", AT, shape=make_mesh(1))}) == 2
    assert hash(make_mesh(2)) == hash(Mesh(make_mesh(2).vertices))
