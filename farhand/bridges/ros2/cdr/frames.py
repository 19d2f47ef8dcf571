"""Frames as bytes: written into what was laid out once, as fifty times a second all of a robot's are told."""

import struct
from collections.abc import Sequence

from farhand.common.messages.base import Quaternion, Vector3

FRAMES = "tf2_msgs/msg/TFMessage"
NANOSECONDS = 1_000_000_000
Frame = tuple[str, Vector3, Quaternion]
"""Name, position (m), and orientation (w, x, y, z)."""
_HEAD = b"\0\1\0\0"
_STAMP, _PLACE = struct.Struct("<iI"), struct.Struct("<7d")


class Frames:
    """Args:
    parent: in which all of them are.
    names: of the frames, in order.
    """

    def __init__(self, parent: str, names: Sequence[str]) -> None:
        body = bytearray(struct.pack("<I", len(names)))
        self._stamps, self._places = [], []
        for name in names:
            self._stamps.append(_room(body, 4, _STAMP.size))
            _string(body, parent)
            _string(body, name)
            self._places.append(_room(body, 8, _PLACE.size))
        self._bytes = bytearray(_HEAD) + body

    def encode(self, time_ns: int, frames: Sequence[Frame]) -> bytes:
        """CDR of an instant (ns) and a frame for each name."""
        whole, (sec, nanosec) = self._bytes, divmod(time_ns, NANOSECONDS)
        for stamp, place, (_, at, (w, x, y, z)) in zip(self._stamps, self._places, frames, strict=True):
            _STAMP.pack_into(whole, stamp, sec, nanosec)
            _PLACE.pack_into(whole, place, *at, x, y, z, w)
        return bytes(whole)


def _room(body: bytearray, to: int, size: int) -> int:
    """Room for so many bytes at a multiple of `to`; where that is in the message, whose head is not counted."""
    body.extend(bytes(-len(body) % to))
    at = len(body) + len(_HEAD)
    body.extend(bytes(size))
    return at


def _string(body: bytearray, text: str) -> None:
    body.extend(bytes(-len(body) % 4))
    found = text.encode() + b"\0"
    body.extend(struct.pack("<I", len(found)) + found)
