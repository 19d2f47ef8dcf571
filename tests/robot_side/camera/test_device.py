"""A real camera, with one that OpenCV would open in its place: its stamps, and what is said when it is not there."""

import queue
import sys
from types import SimpleNamespace

import numpy as np
import pytest

from farhand.common.errors import InputError
from farhand.robot_side.camera.device import DeviceCamera
from farhand.robot_side.camera.settings import Pictures
from farhand.robot_side.camera.source import Seen
from farhand.testing import ROBOT_SESSION, state

MS, SECOND = 1_000_000, 1_000_000_000


class Capture:
    """cv2.VideoCapture: gives what is put into it."""

    def __init__(self, path):
        self.path, self.given, self.open = path, queue.Queue(), path != "/dev/none"
        CAPTURES.append(self)

    def isOpened(self):  # noqa: N802
        return self.open

    def set(self, _name, _value):
        pass

    def read(self):
        picture = self.given.get()
        return picture is not None, picture

    def release(self):
        self.open = False


CAPTURES = []


@pytest.fixture
def opencv(monkeypatch):
    CAPTURES.clear()
    fake = SimpleNamespace(
        VideoCapture=Capture,
        CAP_PROP_FRAME_WIDTH=3,
        CAP_PROP_FRAME_HEIGHT=4,
        COLOR_BGR2RGB=4,
        INTER_AREA=3,
        cvtColor=lambda picture, _how: picture[:, :, ::-1],
        resize=lambda picture, size, interpolation: np.zeros((size[1], size[0], 3), np.uint8) + picture[0, 0],
    )
    monkeypatch.setitem(sys.modules, "cv2", fake)


class Clock:
    now = SECOND

    def __call__(self):
        return self.now


def shot(camera, seen=Seen()):  # noqa: B008
    while (found := camera.shoot(seen)) is None:
        pass
    return found


def blue(width=640, height=480):
    return np.zeros((height, width, 3), np.uint8) + np.array([200, 0, 0], np.uint8)


def test_a_picture_is_scaled_and_stamped_by_the_newest_state_or_not_at_all(opencv):
    clock = Clock()
    camera = DeviceCamera("device:/dev/video0", Pictures(), clock)
    (capture,) = CAPTURES
    assert capture.path == "/dev/video0"
    capture.given.put(blue())
    seen = Seen(state(1, t_sample_ns=7 * SECOND), SECOND - 30 * MS)
    found = shot(camera, seen)
    assert found.picture.shape == (240, 320, 3)
    assert found.picture[0, 0].tolist() == [0, 0, 200]  # red, green, blue
    assert (found.robot_session, found.t_captured_ns) == (ROBOT_SESSION, 7 * SECOND + 30 * MS)
    assert camera.shoot(seen) is None  # once
    capture.given.put(blue())
    late = Seen(state(1, t_sample_ns=7 * SECOND), SECOND - 1001 * MS)
    assert shot(camera, late).robot_session == 0  # the robot's clock is not known any more
    camera._closing.set()
    capture.given.put(None)
    camera.close()
    assert not capture.open


def test_one_that_gives_nothing_is_said_and_one_that_hangs_stops_nobody(opencv):
    camera = DeviceCamera("device:3", Pictures(), Clock())
    (capture,) = CAPTURES
    assert capture.path == 3
    assert camera.shoot(Seen()) is None  # it hangs in its reading
    capture.given.put(None)
    while not camera.trouble:
        pass
    assert camera.trouble == "device:3 gives no picture"
    camera._closing.set()
    capture.given.put(None)
    camera.close()


def test_without_opencv_or_without_the_device_one_line_says_so(opencv, monkeypatch):
    with pytest.raises(InputError, match="device:/dev/none: cannot be opened"):
        DeviceCamera("device:/dev/none", Pictures(), Clock())
    monkeypatch.setitem(sys.modules, "cv2", None)
    with pytest.raises(InputError, match=r"pip install 'farhand\[camera\]'"):
        DeviceCamera("device:/dev/video0", Pictures(), Clock())
