"""The tool at the joints' positions, by compiled kinematics: what is asked at every tick."""

import numpy as np

from farhand.common.geometry import Array
from farhand.robot_side.arm.kinematics import ToolKinematics
from farhand.robot_side.arm.model import ArmModel
from farhand.robot_side.kernel.chain import moving_tool, pack, parts


class ArmChain:
    """Kinematics of one arm in arrays of its own, which each call fills anew and nobody else replaces.

    Args:
        arm: which.

    Attributes:
        packed: (n + 1, 15), as robot_side/kernel/chain.py reads it.
        joints: (2 n,) positions, then velocities, of the joints (rad, rad/s); may be written, for `refresh`.
        q, qd: (n,) the two halves of it.
        placed: all that follows, in one array.
        R_base_joint, p_base_joint: (n, 3, 3), (n, 3) the joints' frames in base (m).
        tool: pose and Jacobian.
        state: (13,) of the tool: position (m), velocity (m/s), orientation (w, x, y, z), turning (rad/s), in base.
    """

    def __init__(self, arm: ArmModel) -> None:
        n = arm.n
        self.packed = pack(arm.R_parent_joint, arm.p_parent_joint, arm.axes, arm.R_last_tool, arm.p_last_tool)
        self.joints: Array = np.zeros(2 * n)
        self.q, self.qd = self.joints[:n], self.joints[n:]
        self.placed: Array = np.zeros(18 * n + 25)
        self.R_base_joint: Array
        self.p_base_joint: Array
        self.state: Array
        self.R_base_joint, self.p_base_joint, R_tool, p_tool, J, self.state = parts(self.placed, n)
        self.tool = ToolKinematics(p_tool, R_tool, J)
        self.at(arm.home, np.zeros(n))

    def at(self, q: Array, qd: Array) -> ToolKinematics:
        """Fill everything at joint positions and velocities q, qd (n,), rad and rad/s; returns `tool`."""
        self.q[:], self.qd[:] = q, qd
        return self.refresh()

    def refresh(self) -> ToolKinematics:
        """Fill everything at `joints`; returns `tool`."""
        moving_tool(self.packed, self.joints, self.placed)
        return self.tool
