"""The distance that a sentence names: of the obstacle that it names, at the state's instant, off the tool's sphere."""

import pytest

from farhand.common.link.link import Packet
from farhand.common.messages.codec import encode
from farhand.common.messages.keys import mirror_key
from farhand.common.messages.scene import Obstacle
from farhand.operator_side.console.nearness import tool_to
from farhand.operator_side.console.picture import Picture
from farhand.testing import description, scene, state


def seen(**messages):
    picture = Picture("r")
    for kind, message in messages.items():
        picture.take(Packet(mirror_key("r", kind), encode(message), 0))
    return picture


BALL = Obstacle("ball", (0.5, 0.0, 0.0), 0.1)
POST = Obstacle("post", (0.0, 1.0, 0.0), 0.1, velocity=(0.0, -0.5, 0.0))


def test_it_is_of_the_one_that_is_named_not_of_the_nearest():
    picture = seen(
        state=state(1, position=(0.0, 0.0, 0.0), t_sample_ns=1_500_000_000),
        scene=scene(1, BALL, POST, t_sample_ns=500_000_000),
        description=description(1, radius=0.05),
    )
    assert tool_to(picture, "ball") == pytest.approx(0.35)
    assert tool_to(picture, "post") == pytest.approx(0.35)  # 0.85 less the way of a second
    assert tool_to(picture, "unknown") is None


def test_it_is_not_told_before_all_is_known():
    assert tool_to(seen(state=state(1), scene=scene(1, BALL)), "ball") is None
