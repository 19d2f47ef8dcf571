"""The orientation that the tool keeps: it turns as commanded, and is held while nothing is commanded."""

import numpy as np
import pinocchio as pin

from farhand.common.geometry import Array
from farhand.robot_side.arm.kinematics import rotation_error

LEAD = 0.2
"""The reference runs ahead of the tool by at most this (rad): an arm that cannot follow must not wind it up."""


class OrientationReference:
    """Args:
        R_base_wanted: (3, 3) at the start.

    Attributes:
        R_base_wanted: (3, 3) now.
    """

    def __init__(self, R_base_wanted: Array) -> None:
        self.R_base_wanted = R_base_wanted

    def turn(self, omega_in_base: Array, R_base_tool: Array, dt: float) -> None:
        """Turn for one period.

        Args:
            omega_in_base: (3,) commanded angular velocity (rad/s); zero holds the reference as it is.
            R_base_tool: (3, 3) of the tool now.
            dt: (s).
        """
        if not omega_in_base.any():
            return
        turned = pin.exp3(omega_in_base * dt) @ self.R_base_wanted
        lead = rotation_error(turned, R_base_tool)
        excess = float(np.linalg.norm(lead)) / LEAD
        self.R_base_wanted = turned if excess <= 1.0 else pin.exp3(lead / excess) @ R_base_tool
