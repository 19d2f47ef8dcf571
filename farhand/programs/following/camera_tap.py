"""Pictures that pass an operator's report endpoint, for its recorder: some a second, each with its time of day."""

import math
from collections import deque

import zenoh

from farhand.common.messages.camera import CameraFrame
from farhand.common.messages.codec import Decoder
from farhand.common.messages.keys import mirror_key
from farhand.common.timing.clock import SystemClock

WAITING = 64
"""Pictures, between two looks."""


class CameraTap:
    """Args:
    session: to the report endpoint.
    robot: the robot's name.
    clock: of this process.
    rate_hz: pictures a second that are kept, of a camera that takes more; 0: none.
    most: bytes a second that are kept; larger pictures are fewer.
    """

    def __init__(
        self,
        session: zenoh.Session,
        robot: str,
        clock: SystemClock,
        rate_hz: float,
        *,
        most: float = math.inf,
    ) -> None:
        self._clock, self._most = clock, most
        self._between_ns = 1e9 / rate_hz if rate_hz > 0.0 else 0.0
        self._next_ns = 0.0
        self._decoder = Decoder(CameraFrame)
        self._waiting: deque[tuple[int, bytes]] = deque(maxlen=WAITING)
        self._subscriber = (
            session.declare_subscriber(mirror_key(robot, "camera"), self._take) if rate_hz else None
        )

    def frames(self) -> list[tuple[int, CameraFrame]]:
        """What has come since the last call: time of day (ns since 1970) and picture."""
        found = []
        epoch_ns = self._clock.epoch_ns()
        while self._waiting:
            arrived_ns, payload = self._waiting.popleft()
            frame = self._decoder.decode(payload)
            if frame is not None:
                found.append((arrived_ns + epoch_ns, frame))
        return found

    def _take(self, sample: zenoh.Sample) -> None:
        """In a Zenoh thread: keep one whose time has come, where a quarter of the period is none too early."""
        now_ns = self._clock.now_ns()
        if now_ns < self._next_ns - self._between_ns / 4:
            return
        payload = sample.payload.to_bytes()
        between_ns = max(self._between_ns, len(payload) * 1e9 / self._most)
        self._next_ns = max(self._next_ns, now_ns - self._between_ns) + between_ns
        self._waiting.append((now_ns, payload))
