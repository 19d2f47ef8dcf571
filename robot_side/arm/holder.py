"""What keeps the arm from following a tool velocity: a joint's limit, its reach, a singularity, a joint's speed."""

import numpy as np

from farhand.common.geometry import Array
from farhand.robot_side.arm.kinematics import Kinematics
from farhand.robot_side.arm.model import ArmModel
from farhand.robot_side.kernel.velocity import SINGULAR_BELOW

SLOW = 0.005
"""Who wants less than this (m/s) is held by nothing."""
FOLLOWED = 0.5
"""Of the wanted speed along the wanted line."""
NEAR_LIMIT = 0.05
"""To a joint's limit (rad): the braking before it has set in."""
STRAIGHT = 0.25
"""Of the elbow's sine, under which the arm is stretched or folded."""


def holder(kinematics: Kinematics, q: Array, jacobian: Array, commanded: Array, wanted: Array) -> str:
    """One of the words above; empty where the arm follows.

    Args:
        kinematics: of the arm.
        q: (n,) joint positions (rad).
        jacobian: (6, n) of the tool at q, linear part first.
        commanded: (n,) joint velocities that were commanded for it (rad/s).
        wanted: (3,) tool velocity (m/s).
    """
    speed = float(np.linalg.norm(wanted))
    if speed < SLOW or float((jacobian[:3] @ commanded) @ wanted) >= FOLLOWED * speed**2:
        return ""
    # What the joints would have to do, a little damped, so that a singular arm has an answer as well.
    least = 1e-4 * np.eye(6)
    free = jacobian.T @ np.linalg.solve(jacobian @ jacobian.T + least, np.concatenate([wanted, np.zeros(3)]))
    up = (kinematics.upper - q < NEAR_LIMIT) & (free > 0.0)
    down = (q - kinematics.lower < NEAR_LIMIT) & (free < 0.0)
    limited = np.flatnonzero(up | down)
    if limited.size:
        return f"joint limit of {kinematics.arm.joint_names[int(limited[0])]}"
    if float(np.linalg.svd(jacobian, compute_uv=False)[-1]) < SINGULAR_BELOW:
        return _singularity(q, kinematics.arm)
    fast = np.abs(free) / kinematics.max_velocity
    return (
        f"speed limit of {kinematics.arm.joint_names[int(np.argmax(fast))]}"
        if float(fast.max()) > 1.0
        else ""
    )


def _singularity(q: Array, arm: ArmModel) -> str:
    """Which one, where it is known what tells them apart."""
    if arm.elbow >= 0 and abs(np.sin(q[arm.elbow])) < STRAIGHT:
        return "the edge of its reach"
    if arm.wrist >= 0 and abs(np.sin(q[arm.wrist])) < STRAIGHT:
        return "a singularity of the wrist"
    return "a singularity"
