"""The tool at the joints' positions, by compiled kinematics: what is asked at every tick."""

import numpy as np

from farhand.common.geometry import Array
from farhand.robot_side.arm.kinematics import ToolKinematics
from farhand.robot_side.arm.model import ArmModel
from farhand.robot_side.kernel.chain import moving_tool, pack


class ArmChain:
    """Kinematics of one arm in arrays of its own, which each call fills anew.

    Args:
        arm: which.

    Attributes:
        packed: (n + 1, 15), as robot_side/kernel/chain.py reads it.
        R_base_joint, p_base_joint: (n, 3, 3), (n, 3) the joints' frames in base (m).
        tool: pose and Jacobian.
        state: (13,) of the tool: position (m), velocity (m/s), orientation (w, x, y, z), turning (rad/s), in base.
    """

    def __init__(self, arm: ArmModel) -> None:
        n = arm.n
        self.packed = pack(arm.R_parent_joint, arm.p_parent_joint, arm.axes, arm.R_last_tool, arm.p_last_tool)
        self.R_base_joint: Array = np.zeros((n, 3, 3))
        self.p_base_joint: Array = np.zeros((n, 3))
        self.tool = ToolKinematics(np.zeros(3), np.zeros((3, 3)), np.zeros((6, n)))
        self.state: Array = np.zeros(13)
        self.at(arm.home, np.zeros(n))

    def at(self, q: Array, qd: Array) -> ToolKinematics:
        """Fill everything at joint positions and velocities q, qd (n,), rad and rad/s; returns `tool`."""
        tool = self.tool
        moving_tool(
            self.packed,
            q,
            qd,
            self.R_base_joint,
            self.p_base_joint,
            tool.R_base_tool,
            tool.position,
            tool.jacobian,
            self.state,
        )
        return tool
