"""Poses as the controller has them: position (m) and rotation vector (rad), in its base.

That base is the arm's `base_link` of the URDF turned by half a turn about z.
"""

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from farhand.common.geometry import Array
from farhand.common.quantities import Vector3
from farhand.robot_side.arm.model import ArmModel

HALF_TURN: Array = np.diag([-1.0, -1.0, 1.0])
"""Rotation between the controller's base and base_link, either way."""


class Pose(list[float]):
    """x, y, z, rx, ry, rz."""


def to_base(twist: Sequence[float]) -> list[float]:
    """A twist (6,) in base_link, in the controller's base, or the other way round."""
    x, y, z, rx, ry, rz = twist
    return [-x, -y, z, -rx, -ry, rz]


def tcp_pose(arm: ArmModel, q: Array, tcp: Sequence[float]) -> Pose:
    """Pose of the tool's centre point at q (n,), with the offset `tcp` from the flange."""
    R, p = arm.tool_pose(q)
    return _pose(HALF_TURN @ R @ _rotation(tcp), HALF_TURN @ (p + R @ np.array(tcp[:3])))


def flange_of(x: Sequence[float], tcp: Sequence[float]) -> tuple[Vector3, Array]:
    """Position (m) and rotation (3, 3) in base_link of the flange whose tool's centre point has pose x."""
    R = _rotation(x) @ _rotation(tcp).T
    p = HALF_TURN @ (np.array(x[:3]) - R @ np.array(tcp[:3]))
    return (float(p[0]), float(p[1]), float(p[2])), HALF_TURN @ R


def product(one: Sequence[float], other: Sequence[float]) -> Pose:
    """One pose after the other."""
    R = _rotation(one)
    return _pose(R @ _rotation(other), np.array(one[:3]) + R @ np.array(other[:3]))


def difference(one: Sequence[float], other: Sequence[float]) -> Pose:
    """Of the positions; the rotation that leads from the other to the one."""
    return _pose(_rotation(one) @ _rotation(other).T, np.array(one[:3]) - np.array(other[:3]))


def _rotation(pose: Sequence[float]) -> Array:
    R: Array = pin.exp3(np.array(pose[3:6], dtype=float))
    return R


def _pose(R: Array, p: Array) -> Pose:
    return Pose([*p.tolist(), *pin.log3(R).tolist()])
