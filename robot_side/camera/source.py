"""What pictures come from."""

from dataclasses import dataclass
from typing import Protocol

from farhand.common.messages.scene import Scene
from farhand.common.messages.state import RobotState
from farhand.robot_side.camera.strip import Picture


@dataclass(frozen=True, slots=True)
class Seen:
    """What is known of the robot.

    Attributes:
        state: the newest; None: none has come.
        arrived_ns: when it came.
        scene: the newest; None: none has come.
    """

    state: RobotState | None = None
    arrived_ns: int = 0
    scene: Scene | None = None


@dataclass(frozen=True, slots=True)
class Shot:
    """One picture.

    Attributes:
        picture: may be drawn into.
        robot_session, t_captured_ns: as of CameraFrame.
    """

    picture: Picture
    robot_session: int
    t_captured_ns: int


class CameraSource(Protocol):
    """A camera, or what takes its place."""

    name: str
    """What it is called in its pictures."""

    trouble: str
    """Why there is no picture, for people; empty: there is one, or nothing is known to be wrong."""

    def shoot(self, seen: Seen) -> Shot | None:
        """The next picture; None: there is none that is newer than the last."""
        ...

    def close(self) -> None:
        """Give it back."""
        ...
