"""An obstacle's bytes depend on what it is, not on how it came to be."""

import pickle

import msgspec
import pytest

from farhand.common.shapes.box import Box
from farhand.common.shapes.obstacle import Obstacle

OBSTACLES = [
    Obstacle("ball", (0.4, 0.1, 0.2), 0.07),
    Obstacle("ball", (0.4, 0.1, 0.2), 0.07, velocity=(0.1, 0.0, 0.0), acceleration=0.5),
    Obstacle("crate", (0.4, 0.1, 0.2), shape=Box((0.1, 0.1, 0.1))),
    Obstacle(
        "cart",
        shape=Box((0.1, 0.1, 0.1)),
        path=((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)),
        speed=0.2,
        acceleration=1.0,
    ),
]


@pytest.mark.parametrize("obstacle", OBSTACLES)
def test_bytes_are_the_same_after_a_copy_by_pickle_or_wire(obstacle):
    encode = msgspec.msgpack.encode
    assert encode(pickle.loads(pickle.dumps(obstacle))) == encode(obstacle)
    assert encode(msgspec.msgpack.decode(encode(obstacle), type=Obstacle)) == encode(obstacle)
    spelled = msgspec.structs.replace(
        obstacle, velocity=tuple(float(v) for v in obstacle.velocity), phase=0.0
    )
    assert encode(spelled) == encode(obstacle)
