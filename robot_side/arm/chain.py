"""The tool at the joints' positions, by compiled kinematics: what is asked at every tick."""

import numpy as np

from farhand.common.geometry import Array
from farhand.robot_side.arm.kinematics import ToolKinematics
from farhand.robot_side.arm.model import ArmModel
from farhand.robot_side.kernel.chain import forward, pack, tool_state


class ArmChain:
    """Kinematics of one arm in arrays of its own, which each call fills anew.

    Args:
        arm: which.

    Attributes:
        packed: (n + 1, 15), as robot_side/kernel/chain.py reads it.
        R_base_joint, p_base_joint: (n, 3, 3), (n, 3) the joints' frames in base (m).
        tool: pose and Jacobian.
    """

    def __init__(self, arm: ArmModel) -> None:
        n = arm.n
        self.packed = pack(arm.R_parent_joint, arm.p_parent_joint, arm.axes, arm.R_last_tool, arm.p_last_tool)
        self.R_base_joint: Array = np.zeros((n, 3, 3))
        self.p_base_joint: Array = np.zeros((n, 3))
        self.tool = ToolKinematics(np.zeros(3), np.zeros((3, 3)), np.zeros((6, n)))
        self._state: Array = np.zeros(13)
        self.at(arm.home)

    def at(self, q: Array) -> ToolKinematics:
        """Fill everything at joint positions q (n,), rad; returns `tool`."""
        tool = self.tool
        forward(
            self.packed,
            q,
            self.R_base_joint,
            self.p_base_joint,
            tool.R_base_tool,
            tool.position,
            tool.jacobian,
        )
        return tool

    def state(self, qd: Array) -> list[float]:
        """Of the tool at the last q: position (m), velocity (m/s), orientation (w, x, y, z), turning (rad/s).

        Args:
            qd: (n,) joint velocities (rad/s).
        """
        tool = self.tool
        tool_state(tool.R_base_tool, tool.position, tool.jacobian, qd, self._state)
        values: list[float] = self._state.tolist()
        return values
