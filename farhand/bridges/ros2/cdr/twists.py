"""Twists from bytes: what all hosts write is read in one go, as a hundred a second may come; others as any message."""

import struct
from typing import NamedTuple

from farhand.bridges.ros2.cdr.types import Types
from farhand.common.messages.base import Vector3

TWIST = "geometry_msgs/msg/TwistStamped"
_HEAD = b"\0\1\0\0"
_SIZE, _SIX = struct.Struct("<I"), struct.Struct("<6d")
_SIZE_AT, _FRAME_AT = 12, 16
"""Behind the head and the stamp."""


class StampedTwist(NamedTuple):
    """Attributes:
    frame_id: whose axes.
    linear, angular: what is wanted.
    """

    frame_id: str
    linear: Vector3
    angular: Vector3


def read_twist(payload: bytes, types: Types) -> StampedTwist:
    """Of CDR bytes; raises CdrError."""
    found = _plain(payload)
    if found is not None:
        return found
    message = types.decode(payload, TWIST)
    linear, angular = message.twist.linear, message.twist.angular
    return StampedTwist(
        message.header.frame_id,
        (linear.x, linear.y, linear.z),
        (angular.x, angular.y, angular.z),
    )


def _plain(payload: bytes) -> StampedTwist | None:
    """Of little-endian bytes, none too many; None where they are others."""
    if payload[:4] != _HEAD or len(payload) < _FRAME_AT:
        return None
    end = _FRAME_AT + _SIZE.unpack_from(payload, _SIZE_AT)[0]
    at = end + (len(_HEAD) - end) % 8
    if len(payload) != at + _SIX.size or payload[end - 1] or end == _FRAME_AT:
        return None
    try:
        frame_id = payload[_FRAME_AT : end - 1].decode()
    except UnicodeDecodeError:
        return None
    x, y, z, roll, pitch, yaw = _SIX.unpack_from(payload, at)
    return StampedTwist(frame_id, (x, y, z), (roll, pitch, yaw))
