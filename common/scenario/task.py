"""The task: where a robot starts, where it shall go, and what stands in its way."""

from typing import Annotated

from msgspec import Meta

from farhand.common.messages.base import Vector3
from farhand.common.messages.scene import MAX_OBSTACLES, MAX_TARGETS, Obstacle
from farhand.common.scenario.section import Section


class Task(Section, frozen=True, kw_only=True):
    """What is to be done; lengths in m, base frame.

    Attributes:
        name: short name.
        description: one line.
        start: tool position at the start (m).
        targets: to be reached in order (m).
        obstacles: what stands or moves there.
    """

    name: Annotated[str, Meta(min_length=1, max_length=64)]
    description: str = ""
    start: Vector3
    targets: Annotated[tuple[Vector3, ...], Meta(min_length=1, max_length=MAX_TARGETS)]
    obstacles: Annotated[tuple[Obstacle, ...], Meta(max_length=MAX_OBSTACLES)] = ()
