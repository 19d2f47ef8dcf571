"""An operator's program as a console meets it, in place of a real one."""

from farhand.common.link.link import Packet
from farhand.common.messages.camera import CameraFrame
from farhand.common.messages.codec import Decoder, encode
from farhand.common.messages.keys import mirror_key, report_key, steering_key
from farhand.common.messages.scene import Obstacle
from farhand.common.messages.steering import Steering
from farhand.common.timing.clock import SystemClock
from farhand.testing import ROBOT_SESSION, command, description, report, scene, state


class Operator:
    """An operator's program as a console meets it: what it published last is always new."""

    def __init__(self):
        self.clock, self.told, self.seq = SystemClock(), [], 0
        self.told_ns = []
        self.state, self.silent, self.camera, self.pictures = {}, False, False, []
        self.shown = 0
        self.decoder = Decoder(Steering)
        self.obstacles = (Obstacle("ball", (0.5, 0.0, 0.3), 0.07),)

    def send(self, packet):
        assert packet.key == steering_key("r")
        self.told.append(self.decoder.decode(packet.payload))
        self.told_ns.append(self.clock.now_ns())

    def receive(self):
        if self.silent:
            return []
        self.seq += 1
        found = {
            report_key("r"): report(self.seq),
            mirror_key("r", "state"): state(self.seq, **self.state),
            mirror_key("r", "scene"): scene(self.seq, *self.obstacles),
            mirror_key("r", "description"): description(1, model="ur5"),
            mirror_key("r", "command"): command(self.seq, plan=((0.1, 0.0, 0.0),)),
        }
        pictures, self.pictures = self.pictures, []
        self.shown += self.camera
        seen = [Packet(mirror_key("r", "camera"), b"", self.clock.now_ns())] if self.camera else []
        messages = [*found.items(), *((mirror_key("r", "camera"), each) for each in pictures)]
        return seen + [Packet(key, encode(message), self.clock.now_ns()) for key, message in messages]


def frame(seq, captured_ns=0, session=ROBOT_SESSION):
    """A picture whose last byte is its number."""
    return CameraFrame(
        source="r",
        session=3,
        seq=seq,
        t_sent_ns=0,
        camera="pybullet",
        robot_session=session,
        t_captured_ns=captured_ns,
        width=320,
        height=240,
        jpeg=b"jpeg" + bytes([seq % 256]),
    )
