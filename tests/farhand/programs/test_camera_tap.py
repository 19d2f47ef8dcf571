"""Pictures for a recording: so many a second, and so many bytes, whatever the camera."""

import math

import pytest

from farhand.common.messages.camera import CameraFrame
from farhand.common.messages.codec import encode
from farhand.programs.following.camera_tap import CameraTap


class Clock:
    at_ns = 0

    def now_ns(self):
        return self.at_ns

    def epoch_ns(self):
        return 0


class Payload:
    def __init__(self, data):
        self.payload = self
        self.to_bytes = lambda: data


class Session:
    def declare_subscriber(self, _, take):
        self.take = take


@pytest.mark.parametrize(
    ("rate", "most", "size", "expected"),
    [(5.0, 40e3, 7_000, 50), (5.0, 40e3, 40_000, 10), (5.0, math.inf, 40_000, 50), (60.0, 40e3, 8_000, 50)],
)
def test_in_ten_seconds_of_a_camera_of_twenty(rate, most, size, expected):
    clock, session = Clock(), Session()
    tap = CameraTap(session, "r", clock, rate, most=most)
    found = []
    for tick in range(200):
        clock.at_ns = tick * 50_000_000
        session.take(Payload(frame(tick, size)))
        found += tap.frames()
    assert len(found) == pytest.approx(expected, abs=2)
    assert sum(len(each.jpeg) for _, each in found) <= most * 10.0 + 2 * size


def frame(seq, size):
    told = {"source": "r", "session": 1, "seq": seq, "t_sent_ns": 0, "camera": "c", "width": 1, "height": 1}
    return encode(CameraFrame(**told, jpeg=bytes(size)))
