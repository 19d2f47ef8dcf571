"""What a UR controller, or whoever answers in its place, says to Farhand's own RTDE client."""

import struct
from collections.abc import Callable
from typing import Any

from farhand.robot_side.ur.rtde_client import RtdeClient, Wanted
from farhand.robot_side.ur.rtde_codec import DATA, INPUTS, OUTPUTS, START, URCONTROL, VERSION, pack
from farhand.trials.fuzz.target import Target, check

WANTED = Wanted(
    outputs=("timestamp", "actual_q", "robot_mode"),
    optional=("robot_mode",),
    inputs=("input_int_register_24",),
)


class _Socket:
    """Connected; all its bytes have come."""

    def __init__(self, data: bytes) -> None:
        self._data = data

    def recv(self, size: int) -> bytes:
        if not self._data:
            raise BlockingIOError
        data, self._data = self._data[:size], self._data[size:]
        return data

    def send(self, data: bytes) -> int:
        return len(data)

    def close(self) -> None:
        pass


def seeds() -> list[bytes]:
    """A conversation."""
    whole = pack(VERSION, b"\1") + pack(URCONTROL, struct.pack(">4I", 5, 12, 0, 1))
    whole += pack(OUTPUTS, b"\1DOUBLE,VECTOR6D,INT32") + pack(INPUTS, b"\1INT32") + pack(START, b"\1")
    data = pack(DATA, struct.pack(">B7di", 1, 1.0, *[0.1] * 6, 7))
    return [whole, whole + data, pack(OUTPUTS, b"\1DOUBLE,VECTOR6D,NOT_FOUND"), data]


def start() -> Callable[[bytes], None]:
    """See Target."""

    def take(data: bytes) -> None:
        client: Any = RtdeClient("127.0.0.1", WANTED)
        client._socket, client._connecting, client._again_ns = _Socket(data), False, 1 << 62
        client._progress_ns = 1
        client.poll(1)
        client.send([1])
        client.poll(2)
        check("\n" not in client.trouble, "what is wrong is no line")
        check(len(client._buffer) < 1 << 17, "a buffer without bounds")

    return take


TARGET = Target(
    edge="RTDE at Farhand's driver of a UR arm",
    promise="a controller that errs is given up, in a line; no buffer grows",
    seeds=seeds,
    start=start,
)
