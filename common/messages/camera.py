"""A camera to the operator: one picture, and the instant at which it was taken."""

from typing import Annotated

from msgspec import Meta

from farhand.common.messages.base import Message, Name, Stamp

MAX_JPEG = 1_000_000
"""Bytes of a picture that is sent; the message around it must fit a payload of the codec."""
MAX_SIDE = 4096

Side = Annotated[int, Meta(ge=1, le=MAX_SIDE)]


class CameraFrame(Message, frozen=True, kw_only=True):
    """Robot's side to operator, some twenty times a second; any of them may be lost, and only the newest counts.

    `source` is the robot's name, as in a RobotState; `seq` counts the pictures.

    Attributes:
        camera: what took it: `pybullet`, `device:/dev/video0`, or as whoever publishes it calls it.
        robot_session: session of the robot on whose clock the capture is stamped, as its states say it; 0: on no
            robot's, and nobody can tell the picture's age.
        t_captured_ns: when the picture was taken, on that robot's clock, as `RobotState.t_sample_ns`; never later
            than it truly was.
        width, height: in pixels.
        jpeg: the picture.
    """

    camera: Name
    robot_session: Stamp = 0
    t_captured_ns: Stamp = 0
    width: Side
    height: Side
    jpeg: Annotated[bytes, Meta(min_length=4, max_length=MAX_JPEG)]
