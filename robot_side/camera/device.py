"""A real camera by OpenCV, which is an optional part: a thread reads it, so that one that hangs stops nothing."""

import threading
from collections.abc import Callable
from typing import Any

import numpy as np

from farhand.common.errors import InputError
from farhand.common.timing.clock import to_ns
from farhand.robot_side.camera.settings import DEVICE, Pictures
from farhand.robot_side.camera.source import Seen, Shot
from farhand.robot_side.camera.strip import Picture

STATE_LIMIT_NS = to_ns(1.0)
"""A state older than this says nothing of the robot's clock any more."""
CLOSING_TIME = 1.0
_Captured = tuple[Picture, int]


class DeviceCamera:
    """Args:
    name: `device:PATH`, or `device:NUMBER` as OpenCV counts them.
    pictures: what is asked for; a camera that has no such size is scaled.
    now_ns: the clock.

    Raises:
        InputError: OpenCV is not there, or cannot open the device.
    """

    def __init__(self, name: str, pictures: Pictures, now_ns: Callable[[], int]) -> None:
        self.name = name
        self.trouble = ""
        self._cv = _opencv()
        self._size, self._now_ns = (pictures.width, pictures.height), now_ns
        path = name.removeprefix(DEVICE)
        self._device = self._cv.VideoCapture(int(path) if path.isdigit() else path)
        if not self._device.isOpened():
            raise InputError(
                f"--camera {name}: cannot be opened: is it there, is it a camera, may you read it?"
            )
        self._device.set(self._cv.CAP_PROP_FRAME_WIDTH, pictures.width)
        self._device.set(self._cv.CAP_PROP_FRAME_HEIGHT, pictures.height)
        self._newest: _Captured | None = None
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._read, name="camera-device", daemon=True)
        self._thread.start()

    def shoot(self, seen: Seen) -> Shot | None:
        """See CameraSource.

        The instant on the robot's clock is that of the newest state and the time since it came, so that it is earlier
        than the true one by as long as that state was under way on this host; without a fresh state there is none.
        """
        captured, self._newest = self._newest, None
        if captured is None:
            return None
        picture, at_ns = captured
        state = seen.state
        if state is None or not 0 <= at_ns - seen.arrived_ns <= STATE_LIMIT_NS:
            return Shot(picture, 0, 0)
        return Shot(picture, state.session, state.t_sample_ns + at_ns - seen.arrived_ns)

    def close(self) -> None:
        """See CameraSource."""
        self._closing.set()
        self._thread.join(CLOSING_TIME)
        if not self._thread.is_alive():
            self._device.release()

    def _read(self) -> None:
        """Whatever the device gives; a picture is stamped when its reading begins, which is when the last one ended."""
        while not self._closing.is_set():
            at_ns = self._now_ns()
            good, picture = self._device.read()
            if not good:
                self.trouble = f"{self.name} gives no picture"
                self._closing.wait(0.1)
                continue
            self.trouble = ""
            self._newest = self._fitted(picture), at_ns

    def _fitted(self, picture: Any) -> Picture:
        if (picture.shape[1], picture.shape[0]) != self._size:
            picture = self._cv.resize(picture, self._size, interpolation=self._cv.INTER_AREA)
        return np.ascontiguousarray(self._cv.cvtColor(picture, self._cv.COLOR_BGR2RGB))


def _opencv() -> Any:
    try:
        import cv2
    except ImportError:
        raise InputError(
            "--camera device: needs OpenCV, an optional part: pip install 'farhand[camera]'"
        ) from None
    return cv2
