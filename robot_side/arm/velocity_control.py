"""From a twist of the tool to joint velocities: the interface, the law that keeps the direction, a plain baseline.

The law is compiled: robot_side/kernel/velocity.py says what it is.
"""

from typing import Protocol

import numpy as np

from farhand.common.geometry import Array
from farhand.robot_side.arm.kinematics import ToolKinematics, rotation_error
from farhand.robot_side.arm.limits import JointBounds
from farhand.robot_side.kernel.qp import SOLVED
from farhand.robot_side.kernel.rotation import turn_wanted
from farhand.robot_side.kernel.singularity import damping_of
from farhand.robot_side.kernel.velocity import (
    LEAST_SPEED_WEIGHT,
    ORIENTATION_GAIN,
    tick,
)

_NO_TURN: Array = np.zeros(3)


class VelocityControl(Protocol):
    """A law from a twist of the tool to joint velocities. Nothing throws.

    Attributes:
        R_base_wanted: (3, 3) orientation that the tool keeps; it turns as commanded, and is held while nothing is.
    """

    R_base_wanted: Array

    def joint_velocity(
        self,
        q: Array,
        previous: Array,
        tool: ToolKinematics,
        v_tool_in_base: Array,
        dt: float,
        omega_in_base: Array = _NO_TURN,
    ) -> Array:
        """Joint velocities to command now (n,), rad/s.

        Args:
            q: (n,) joint positions (rad).
            previous: (n,) what was commanded last (rad/s).
            tool: kinematics at q, in C order (as ArmChain makes it), for which the kernels are compiled.
            v_tool_in_base: (3,) wanted tool velocity (m/s).
            dt: control period (s).
            omega_in_base: (3,) commanded angular velocity of the tool (rad/s).
        """
        ...


class DirectionKeeping:
    """Gives up speed before it gives up direction.

    Args:
        bounds: of the joint velocities.
        R_base_wanted: (3, 3) orientation that the tool keeps at first.
        home: (n,) where an arm with more than six joints leads those motions that the tool does not feel (rad).

    Attributes:
        failures: solves that did not end well; the arm brakes then.
    """

    def __init__(self, bounds: JointBounds, R_base_wanted: Array, home: Array | None = None) -> None:
        self._limits = bounds.limits
        self.R_base_wanted: Array = np.array(R_base_wanted, dtype=float)
        self._home: Array = np.zeros(bounds.n) if home is None else np.array(home, dtype=float)
        self.failures = 0
        # compiled, or loaded, now and not in the first period
        n, eye = bounds.n, np.eye(3)
        self._n = n
        tick(
            self._limits, self._home, self._home, np.zeros(n), np.zeros((6, n)), eye, eye.copy(), np.zeros(3), _NO_TURN,
            1.0, np.empty(n),
        )  # fmt: skip

    def joint_velocity(
        self,
        q: Array,
        previous: Array,
        tool: ToolKinematics,
        v_tool_in_base: Array,
        dt: float,
        omega_in_base: Array = _NO_TURN,
    ) -> Array:
        """See VelocityControl."""
        answer: Array = np.empty(self._n)
        status = tick(
            self._limits, self._home, q, previous, tool.jacobian, tool.R_base_tool, self.R_base_wanted,
            v_tool_in_base, omega_in_base, dt, answer,
        )  # fmt: skip
        self.failures += status != SOLVED
        return answer


class DampedLeastSquares:
    """The plain baseline: q' = J^T (J J^T + damping I)^-1 (v, w), scaled into the velocity limits.

    Args:
        bounds: of the joint velocities; what exceeds them is cut, which bends the path.
        max_velocity: (n,) rad/s.
        R_base_wanted: (3, 3) orientation that the tool keeps at first.
    """

    def __init__(self, bounds: JointBounds, max_velocity: Array, R_base_wanted: Array) -> None:
        self._bounds = bounds
        self._max_velocity = max_velocity
        self.R_base_wanted = R_base_wanted.copy()

    def joint_velocity(
        self,
        q: Array,
        previous: Array,
        tool: ToolKinematics,
        v_tool_in_base: Array,
        dt: float,
        omega_in_base: Array = _NO_TURN,
    ) -> Array:
        """See VelocityControl."""
        low, high = self._bounds.at(q, previous, dt)
        omega = omega_in_base + ORIENTATION_GAIN * rotation_error(self.R_base_wanted, tool.R_base_tool)
        J = tool.jacobian
        least = LEAST_SPEED_WEIGHT + damping(J)
        qd = J.T @ np.linalg.solve(J @ J.T + least * np.eye(6), np.concatenate([v_tool_in_base, omega]))
        turn_wanted(self.R_base_wanted, tool.R_base_tool, omega_in_base, dt)
        excess = float(np.max(np.abs(qd) / self._max_velocity))
        return np.clip(qd / max(1.0, excess), low, high)


def damping(jacobian: Array) -> float:
    """0 where the arm is well conditioned, rising to MAX_DAMPING^2 where it is singular."""
    return float(damping_of(float(np.linalg.svd(jacobian, compute_uv=False)[-1])))
