"""What keeps the arm from following a tool velocity: a joint's limit, its reach, a singularity, a joint's speed."""

import numpy as np

from farhand.common.geometry import Array
from farhand.robot_side.arm.kinematics import Kinematics
from farhand.robot_side.arm.model import JOINTS
from farhand.robot_side.arm.velocity_control import SINGULAR_BELOW

SLOW = 0.005
"""Who wants less than this (m/s) is held by nothing."""
FOLLOWED = 0.5
"""Of the wanted speed along the wanted line."""
NEAR_LIMIT = 0.05
"""To a joint's limit (rad): the braking before it has set in."""
STRAIGHT = 0.25
"""Of the elbow's sine, under which the arm is stretched or folded."""
_ELBOW, _WRIST = 2, 4


def holder(kinematics: Kinematics, q: Array, jacobian: Array, commanded: Array, wanted: Array) -> str:
    """One of the words above; empty where the arm follows.

    Args:
        kinematics: for the limits.
        q: (6,) joint positions (rad).
        jacobian: (6, 6) of the tool at q, linear part first.
        commanded: (6,) joint velocities that were commanded for it (rad/s).
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
        return f"joint limit of {JOINTS[int(limited[0])]}"
    if float(np.linalg.svd(jacobian, compute_uv=False)[-1]) < SINGULAR_BELOW:
        if abs(np.sin(q[_ELBOW])) < STRAIGHT:
            return "the edge of its reach"
        return "a singularity of the wrist" if abs(np.sin(q[_WRIST])) < STRAIGHT else "a singularity"
    fast = np.abs(free) / kinematics.max_velocity
    return f"speed limit of {JOINTS[int(np.argmax(fast))]}" if float(fast.max()) > 1.0 else ""
