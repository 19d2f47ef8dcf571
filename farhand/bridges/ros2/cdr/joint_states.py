"""Joint states as bytes: written into what was encoded once, as five hundred a second are told."""

import struct
from collections.abc import Sequence

from farhand.bridges.ros2.cdr.types import Types
from farhand.common.messages.base import ZERO
from farhand.common.messages.state import RobotState
from farhand.exports.ros_messages import NANOSECONDS, Ros

JOINT_STATE = "sensor_msgs/msg/JointState"
_STAMP = struct.Struct("<iI")
_STAMP_AT = 4
_EMPTY_REST = 8
"""Bytes of velocity and effort, which are not known."""


class JointStates:
    """Args:
    types: of the distribution.
    ros: makes messages.
    names: of the joints.
    """

    def __init__(self, types: Types, ros: Ros, names: Sequence[str]) -> None:
        count = len(names)
        still = RobotState(source="r", session=0, seq=0, t_sent_ns=0, t_sample_ns=0, position=ZERO, velocity=ZERO,
                           clearance=0.0, min_clearance=0.0, joints=(0.0,) * count)  # fmt: skip
        self._bytes = bytearray(types.encode(ros.joints(0, names, still), JOINT_STATE))
        self._positions = struct.Struct(f"<{count}d")
        self._positions_at = len(self._bytes) - _EMPTY_REST - self._positions.size
        self.count = count

    def encode(self, time_ns: int, positions: Sequence[float]) -> bytes:
        """CDR of an instant (ns) and as many positions (rad) as there are names."""
        _STAMP.pack_into(self._bytes, _STAMP_AT, *divmod(time_ns, NANOSECONDS))
        self._positions.pack_into(self._bytes, self._positions_at, *positions)
        return bytes(self._bytes)
