"""Robot to operator: what is around it."""

from typing import Annotated

from msgspec import Meta

from farhand.common.messages.base import Message, Stamp, Vector3
from farhand.common.shapes.obstacle import Obstacle as Obstacle

MAX_OBSTACLES = 1024
MAX_TARGETS = 256


class Scene(Message, frozen=True, kw_only=True):
    """Robot to operator, on change and once a second.

    Attributes:
        t_sample_ns: instant at which the obstacles were where they are said to be, robot clock.
        obstacles: what to avoid.
        targets: where to go, in order (m).
    """

    t_sample_ns: Stamp
    obstacles: Annotated[tuple[Obstacle, ...], Meta(max_length=MAX_OBSTACLES)] = ()
    targets: Annotated[tuple[Vector3, ...], Meta(max_length=MAX_TARGETS)] = ()
