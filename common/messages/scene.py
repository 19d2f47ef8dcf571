"""Robot to operator: what is around it."""

from typing import Annotated

import msgspec
from msgspec import Meta, Struct

from farhand.common.messages.base import Message, Stamp, Text, Vector3
from farhand.common.shapes.obstacle import Obstacle as Obstacle

MAX_OBSTACLES = 1024
MAX_TARGETS = 256
MAX_ANSWERS = 8


class SceneAnswer(Struct, frozen=True, forbid_unknown_fields=True):
    """What became of a request to change the scene.

    Attributes:
        session: of whoever asked.
        refusal: why it was not obeyed; empty: it was.
        settled: whether asking again, on a newer state, is of no use.
    """

    session: Stamp
    refusal: Text = ""
    settled: bool = True


class Scene(Message, frozen=True, kw_only=True):
    """Robot to operator, on change and once a second.

    Attributes:
        t_sample_ns: instant at which the obstacles were where they are said to be, robot clock.
        obstacles: what to avoid.
        targets: where to go, in order (m).
        revision: changes of the obstacles since the start of the robot's program; left out before the first.
        answers: to the newest requests to change them; left out before the first.
    """

    t_sample_ns: Stamp
    obstacles: Annotated[tuple[Obstacle, ...], Meta(max_length=MAX_OBSTACLES)] = ()
    targets: Annotated[tuple[Vector3, ...], Meta(max_length=MAX_TARGETS)] = ()
    revision: Stamp | msgspec.UnsetType = msgspec.UNSET
    answers: Annotated[tuple[SceneAnswer, ...], Meta(max_length=MAX_ANSWERS)] | msgspec.UnsetType = (
        msgspec.UNSET
    )

    @property
    def changes(self) -> int:
        """The revision, 0 before the first change."""
        return self.revision or 0

    def overtaken_by(self, known: "Scene | None") -> bool:
        """Whether a newer one of the same start of the robot is known already: what this says is over."""
        return known is not None and known.session == self.session and self.seq < known.seq
