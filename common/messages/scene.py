"""Robot to operator: what is around it."""

from typing import Annotated

from msgspec import Meta, Struct

from farhand.common.messages.base import Message, Name, Positive, Stamp, Vector3

MAX_OBSTACLES = 1024
MAX_TARGETS = 256


class Obstacle(Struct, frozen=True, forbid_unknown_fields=True):
    """A spherical obstacle in the base frame.

    Attributes:
        id: its name.
        position: centre (m).
        radius: (m).
        velocity: (m/s).
    """

    id: Name
    position: Vector3
    radius: Positive
    velocity: Vector3 = (0.0, 0.0, 0.0)


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
