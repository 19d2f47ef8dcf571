"""What keeps the arm from following a tool velocity: a joint's limit, its reach, a singularity, a joint's speed."""

import numpy as np

from farhand.common.geometry import Array, norm
from farhand.robot_side.arm.kinematics import Kinematics
from farhand.robot_side.arm.model import ArmModel
from farhand.robot_side.kernel.velocity import along, unbounded

SLOW = 0.005
"""Who wants less than this (m/s) is held by nothing."""
FOLLOWED = 0.5
"""Of the wanted speed along the wanted line."""
NEAR_LIMIT = 0.05
"""To a joint's limit (rad): the braking before it has set in."""
STRAIGHT = 0.25
"""Of the elbow's sine, under which the arm is stretched or folded."""
DAMPING = 1e-4
"""Of what the joints would have to do, so that a singular arm has an answer as well."""
OUTWARD = 0.85
"""Of the lost direction, along the line from the shoulder to the tool, from which an arm is at its reach."""


def prepare(n: int) -> None:
    """Compile, or load, what an arm of n joints is asked with; else the first state of one that is held waits."""
    jacobian, wanted, qd = np.zeros((6, n)), np.zeros(3), np.zeros(n)
    unbounded(jacobian, wanted, DAMPING, qd)
    along(jacobian, qd, wanted)


def holder(kinematics: Kinematics, q: Array, jacobian: Array, commanded: Array, wanted: Array) -> str:
    """One of the words above; empty where the arm follows.

    Args:
        kinematics: of the arm.
        q: (n,) joint positions (rad).
        jacobian: (6, n) of the tool at q, linear part first.
        commanded: (n,) joint velocities that were commanded for it (rad/s).
        wanted: (3,) tool velocity (m/s).
    """
    speed = norm(wanted.tolist())
    if speed < SLOW or along(jacobian, commanded, wanted) >= FOLLOWED * speed**2:
        return ""
    free: Array = np.empty(len(q))
    regular = unbounded(np.ascontiguousarray(jacobian), wanted, DAMPING, free)
    up = (kinematics.upper - q < NEAR_LIMIT) & (free > 0.0)
    down = (q - kinematics.lower < NEAR_LIMIT) & (free < 0.0)
    limited = np.flatnonzero(up | down)
    if limited.size:
        return f"joint limit of {kinematics.arm.joint_names[int(limited[0])]}"
    if not regular:
        return _singularity(q, jacobian, kinematics.arm)
    fast = np.abs(free) / kinematics.max_velocity
    fastest = kinematics.arm.joint_names[int(np.argmax(fast))]
    return f"speed limit of {fastest}" if float(fast.max()) > 1.0 else ""


def _singularity(q: Array, jacobian: Array, arm: ArmModel) -> str:
    """Which one, where that can be told apart."""
    if _is_stretched(q, jacobian, arm):
        return "the edge of its reach"
    if arm.wrist >= 0 and abs(np.sin(q[arm.wrist])) < STRAIGHT:
        return "a singularity of the wrist"
    return "a singularity"


def _is_stretched(q: Array, jacobian: Array, arm: ArmModel) -> bool:
    """By the elbow, where it is known; else, whether the lost direction is that from the shoulder to the tool."""
    if arm.elbow >= 0:
        return bool(abs(np.sin(q[arm.elbow])) < STRAIGHT)
    lost = np.linalg.svd(jacobian)[0][:3, -1]
    outward = arm.tool_pose(q)[1] - arm.poses(q)[1][1]
    return bool(abs(lost @ outward) > OUTWARD * np.linalg.norm(outward))
