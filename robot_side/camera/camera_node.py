"""The camera's node: hears the robot, takes a picture when one is due, sends it. Told the time, as every node."""

from collections.abc import Callable

from farhand.common.errors import InputError
from farhand.common.link.link import Link, Packet
from farhand.common.messages.camera import MAX_JPEG, CameraFrame
from farhand.common.messages.codec import Decoder, encode
from farhand.common.messages.echo import Newest
from farhand.common.messages.keys import camera_key, scene_key, state_key
from farhand.common.messages.scene import Scene
from farhand.common.messages.state import RobotState
from farhand.common.timing.clock import to_ns
from farhand.common.timing.periodic import Periodic
from farhand.robot_side.camera.settings import Pictures
from farhand.robot_side.camera.source import CameraSource, Seen
from farhand.robot_side.camera.strip import Picture, draw_strip

TROUBLE_AFTER_NS = 2_000_000_000
"""For how long there must be no picture until that is said."""

Encode = Callable[[Picture, int], bytes]
"""A picture and a quality; the JPEG."""


def encoder() -> Encode:
    """By simplejpeg; raises InputError where that is not there."""
    try:
        import simplejpeg
    except ImportError:
        raise InputError("the camera needs simplejpeg: pip install simplejpeg") from None

    def encode_jpeg(picture: Picture, quality: int) -> bytes:
        space = "RGBA" if picture.shape[2] == 4 else "RGB"
        return bytes(simplejpeg.encode_jpeg(picture, quality, space, "420"))

    return encode_jpeg


class CameraNode:
    """Args:
    robot: the robot's name.
    session: this start of the program.
    link: to the robot and to the operator.
    source: of the pictures.
    pictures: how many, and how good.
    compress: see Encode.

    Attributes:
        sent: pictures so far.
        too_large: pictures that no message holds.
        trouble: why there has been no picture for 2 s, for people; empty: there is one.
    """

    def __init__(
        self,
        robot: str,
        session: int,
        link: Link,
        source: CameraSource,
        pictures: Pictures,
        compress: Encode,
    ) -> None:
        self.sent = self.too_large = 0
        self.trouble = ""
        self._robot, self._session, self._link, self._source = robot, session, link, source
        self._pictures, self._compress = pictures, compress
        self._periodic = Periodic(to_ns(1.0 / pictures.rate_hz))
        self._states, self._scenes = Decoder(RobotState), Decoder(Scene)
        self._newest_state, self._newest_scene = Newest(), Newest()
        self._state: RobotState | None = None
        self._scene: Scene | None = None
        self._last_ns: int | None = None

    def step(self, now_ns: int) -> int | None:
        """Take what has come; take a picture where one is due."""
        self._hear()
        if self._last_ns is None:
            self._last_ns = now_ns
        if self._periodic.due(now_ns):
            if self._shoot(now_ns):
                self._last_ns, self.trouble = now_ns, ""
            elif now_ns - self._last_ns >= TROUBLE_AFTER_NS:
                self.trouble = self._source.trouble or "the camera gives no picture"
        return self._periodic.next_ns

    def _hear(self) -> None:
        for packet in self._link.receive():
            if packet.key == state_key(self._robot):
                state = self._states.decode(packet.payload)
                if state is not None and self._newest_state.accept(state, packet.arrived_ns):
                    self._state = state
            elif packet.key == scene_key(self._robot):
                scene = self._scenes.decode(packet.payload)
                if scene is not None and self._newest_scene.accept(scene, packet.arrived_ns):
                    self._scene = scene

    def _shoot(self, now_ns: int) -> bool:
        """Whether there was a picture."""
        shot = self._source.shoot(Seen(self._state, self._newest_state.arrived_ns, self._scene))
        if shot is None:
            return False
        draw_strip(shot.picture, shot.t_captured_ns)
        jpeg = self._compress(shot.picture, self._pictures.quality)
        height, width = shot.picture.shape[:2]
        if len(jpeg) > MAX_JPEG:
            self.too_large += 1
            self._source.trouble = (
                f"a picture has {len(jpeg)} bytes, at most {MAX_JPEG} can be sent: lower --quality"
            )
            return False
        frame = CameraFrame(
            source=self._robot,
            session=self._session,
            seq=self.sent,
            t_sent_ns=now_ns,
            camera=self._source.name,
            robot_session=shot.robot_session,
            t_captured_ns=shot.t_captured_ns,
            width=width,
            height=height,
            jpeg=jpeg,
        )
        self.sent += 1
        self._link.send(Packet(camera_key(self._robot), encode(frame)))
        return True
