"""What is known, sent and decided by whoever changes a robot's scene: a state machine that is told the time."""

from dataclasses import dataclass
from typing import Annotated

import msgspec
from msgspec import Meta

from farhand.common.errors import InputError
from farhand.common.messages.base import Echo, Name
from farhand.common.messages.codec import encode
from farhand.common.messages.scene import MAX_OBSTACLES, Obstacle, Scene
from farhand.common.messages.scene_request import MOST_BYTES_ASKED, SceneDeed, SceneRequest
from farhand.common.messages.state import RobotState


class Change(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What is wanted; see SceneRequest."""

    deed: SceneDeed
    obstacles: Annotated[tuple[Obstacle, ...], Meta(max_length=MAX_OBSTACLES)] = ()
    gone: Annotated[tuple[Name, ...], Meta(max_length=MAX_OBSTACLES)] = ()


def checked(change: Change) -> Change:
    """The same; raises InputError where no robot would look at it."""
    for name in change.gone:
        try:
            msgspec.convert(name, Name)
            name.encode()
        except (msgspec.ValidationError, UnicodeEncodeError):
            raise InputError(
                f"scene {change.deed} {name!r}: no name of an obstacle; expected 1 to 64 characters"
            ) from None
    many = max(len(change.obstacles), len(change.gone))
    if many > MAX_OBSTACLES:
        raise InputError(f"scene {change.deed}: {many} obstacles; a scene has at most {MAX_OBSTACLES}")
    size = len(msgspec.msgpack.encode(change))
    if size > MOST_BYTES_ASKED:
        raise InputError(
            f"scene {change.deed}: takes {size} bytes on the wire, at most {MOST_BYTES_ASKED} are possible while the "
            "robot runs; ask in parts, or leave out vertices of meshes"
        )
    return change


@dataclass(frozen=True, slots=True)
class Asker:
    """Attributes:
    name: who asks, for the robot.
    session: for this one change, new for each.
    """

    name: str
    session: int


class SceneAsking:
    """Asks a robot for one change until it has answered.

    Args:
        asker: who asks.
        change: what is wanted.

    Attributes:
        done: whether the robot has decided.
        refusal: why it refused, or refused last; empty: it obeyed, or has said nothing yet.
        asked: whether a request was sent, so that it may have been obeyed.
        scene: the newest that came from the robot.
    """

    def __init__(self, asker: Asker, change: Change) -> None:
        self._asker, self._change = asker, change
        self._base: int | None = None
        self._seq = 0
        self.done = False
        self.refusal = ""
        self.scene: Scene | None = None

    @property
    def asked(self) -> bool:
        """Whether a request was sent."""
        return self._seq > 0

    def see(self, scene: Scene | None) -> None:
        """Take the robot's newest scene, which may hold the answer."""
        if scene is None or self.done:
            return
        self.scene = scene
        for answer in scene.answers or ():
            if answer.session == self._asker.session:
                self.refusal, self.done = answer.refusal, answer.settled

    def step(self, state: RobotState | None, now_ns: int) -> bytes | None:
        """The request to send now, on the robot's newest state; None: nothing is to be asked, or known yet."""
        scene = self.scene
        if self.done or state is None or scene is None or state.session != scene.session:
            return None
        if self._base is None:
            self._base = scene.changes
        request = SceneRequest(
            source=self._asker.name,
            session=self._asker.session,
            seq=self._seq,
            t_sent_ns=now_ns,
            echo=Echo(state.session, state.seq, state.t_sent_ns, 0),
            deed=self._change.deed,
            base=self._base,
            obstacles=self._change.obstacles,
            gone=self._change.gone,
        )
        self._seq += 1
        return encode(request)
