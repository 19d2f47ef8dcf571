"""The camera's node: what it draws is what the robot said, under that instant; and nothing twice."""

import numpy as np
import pytest
import simplejpeg

from farhand.common.link.link import Packet
from farhand.common.messages.camera import CameraFrame
from farhand.common.messages.codec import Decoder, encode
from farhand.common.messages.keys import camera_key, scene_key, state_key
from farhand.robot_side.camera.camera_node import CameraNode, encoder
from farhand.robot_side.camera.settings import Pictures
from farhand.robot_side.camera.source import Seen, Shot
from farhand.robot_side.camera.strip import read_strip
from farhand.robot_side.camera.view import BulletView
from farhand.runs.scenario import load_scenario
from farhand.testing import ROBOT_SESSION, obstacle, scene, state

MS, SECOND = 1_000_000, 1_000_000_000
HOME = (-0.245, -1.63634, 1.97671, -1.91116, -1.5708, -0.245)
SCENARIO = load_scenario("ur5-obstacle")


class Bench:
    """A camera's node, what it hears, and what it sends."""

    def __init__(self, source, **pictures):
        self.now, self.waiting, self.frames = 5 * SECOND, [], []
        self.decoder = Decoder(CameraFrame)
        self.node = CameraNode("r", 3, self, source, Pictures(**pictures), encoder())

    def hears(self, *messages):
        for message in messages:
            key = state_key("r") if hasattr(message, "joints") else scene_key("r")
            self.waiting.append(Packet(key, encode(message), self.now))

    def receive(self):
        waiting, self.waiting = self.waiting, []
        return waiting

    def send(self, packet):
        assert packet.key == camera_key("r")
        self.frames.append(self.decoder.decode_or_raise(packet.payload))

    def runs(self, seconds):
        end = self.now + round(seconds * SECOND)
        while self.now < end:
            self.now = self.node.step(self.now)
        return self.frames


@pytest.fixture(scope="module")
def view():
    view = BulletView(SCENARIO.robot, SCENARIO.camera, Pictures())
    yield view
    view.close()


def pixels(frame):
    return simplejpeg.decode_jpeg(frame.jpeg).astype(int)


def test_a_picture_carries_the_instant_of_the_state_it_shows_in_it_and_beside_it(view):
    bench = Bench(view)
    bench.hears(state(1, joints=HOME, t_sample_ns=123_456_789_012_345))
    (frame,) = bench.runs(0.5)  # one state: one picture, however often one is due
    assert (frame.robot_session, frame.t_captured_ns) == (ROBOT_SESSION, 123_456_789_012_345)
    assert read_strip(pixels(frame)) == frame.t_captured_ns
    assert (frame.width, frame.height, frame.camera, frame.source) == (320, 240, "pybullet", "r")


def test_arm_and_obstacles_are_where_the_messages_say(view):
    bench = Bench(view)
    ball = obstacle("ball", position=(0.45, 0.0, 0.3), radius=0.07, velocity=(0.0, 0.1, 0.0))
    bench.hears(scene(1, ball, t_sample_ns=0), state(10, joints=HOME, t_sample_ns=0))
    bench.runs(0.06)
    bench.hears(state(11, joints=HOME, t_sample_ns=2 * SECOND))
    bench.runs(0.06)
    bench.hears(state(12, joints=(1.2, *HOME[1:]), t_sample_ns=2 * SECOND), scene(2, t_sample_ns=0))
    bench.runs(0.06)
    first, second, third = map(pixels, bench.frames)

    def amber(picture):
        red, green, blue = (picture[:220, :, channel] for channel in range(3))
        return np.argwhere((red > 90) & (red - blue > 60) & (green > 50))

    assert 50 < len(amber(first)) < 3000
    moved = amber(second).mean(axis=0) - amber(first).mean(axis=0)
    assert moved[1] > 10  # 0.2 m along y, to the right of who looks from there
    assert len(amber(third)) == 0
    grey = [np.argwhere(picture[:220].min(axis=2) > 120) for picture in (first, third)]
    assert len(grey[0]) > 300  # the arm is lit
    assert abs(grey[1].mean(axis=0) - grey[0].mean(axis=0)).max() > 5  # and turned


def test_old_states_and_those_of_another_arm_are_not_drawn_and_that_is_said(view):
    bench = Bench(view)
    bench.runs(2.5)
    assert bench.node.trouble == "no state comes from the robot"
    bench.hears(state(20, joints=HOME), state(19, joints=HOME))
    assert len(bench.runs(0.2)) == 1
    assert bench.node.trouble == ""
    bench.hears(state(21, joints=(0.0,) * 7))
    bench.runs(2.5)
    assert len(bench.frames) == 1
    assert bench.node.trouble == "the robot has 7 joints, and the scenario's 6"


class Noise:
    """A source whose pictures JPEG cannot make small."""

    name, trouble = "noise", ""

    def shoot(self, _seen: Seen):
        picture = np.random.default_rng(1).integers(0, 256, (1080, 1920, 3), np.uint8)
        return Shot(picture, 0, 0)


def test_a_picture_that_no_message_holds_is_not_sent_and_that_is_said():
    bench = Bench(Noise(), rate_hz=1.0, quality=95)
    assert bench.runs(3.0) == []
    assert "at most 1000000 can be sent: lower --quality" in bench.node.trouble
    assert bench.node.too_large >= 3


def test_every_built_in_scenario_has_a_view(view):
    for name in ("box-obstacle", "panda-obstacle", "table"):
        scenario = load_scenario(name)
        one = BulletView(scenario.robot, scenario.camera, Pictures(width=160, height=120))
        joints = tuple(one._arm.home.tolist()) if one._arm else ()
        told = state(1, joints=joints, position=scenario.start)
        shot = one.shoot(Seen(told, 0, scene(1, *scenario.obstacles)))
        assert int(shot.picture[:, :, :3].max()) > 120, name
        one.close()
