"""Whoever may command to robot: obstacles of its scene come, go, or are all replaced."""

from typing import Annotated, Literal

from msgspec import Meta

from farhand.common.messages.base import Message, Name, Stamp
from farhand.common.messages.scene import MAX_OBSTACLES, Obstacle

SceneDeed = Literal["set", "add", "remove"]

MOST_BYTES_ASKED = 48_000
"""Of the obstacles of one request, and MOST_BYTES_LIVE of all after it: hulls of meshes and distances are computed in
the robot's loop, which must not wait for them."""
MOST_BYTES_LIVE = 128_000
MOST_MOVERS = 100
"""That a change may leave: each is moved at every tick."""


class SceneRequest(Message, frozen=True, kw_only=True):
    """One change of a scene, sent again until it is answered in a Scene. A session asks for one change only.

    It is obeyed once at the most: only while the scene is at the revision that it was made for, and only if its echo
    is of a recent state of this start of the robot's program.

    Attributes:
        deed: `set` replaces all obstacles, `add` brings some, `remove` takes some away.
        base: revision of the scene that is to be changed.
        obstacles: that come, with `set` and `add`, as they are when it is obeyed.
        gone: names of those that go, with `remove`.
    """

    deed: SceneDeed
    base: Stamp
    obstacles: Annotated[tuple[Obstacle, ...], Meta(max_length=MAX_OBSTACLES)] = ()
    gone: Annotated[tuple[Name, ...], Meta(max_length=MAX_OBSTACLES)] = ()
