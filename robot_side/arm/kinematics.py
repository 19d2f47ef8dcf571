"""Kinematics of an arm by Pinocchio: base to tool frame, everything expressed in the base frame."""

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from farhand.common.geometry import Array
from farhand.common.messages.base import Vector3
from farhand.robot_side.arm.description.variants import bare_text
from farhand.robot_side.arm.model import ArmModel

POSITION_TOLERANCE = 1e-6  # m
ANGLE_TOLERANCE = 1e-6  # rad
_ITERATIONS = 200
_DAMPING = 1e-6
_TURNS = (0.0, 0.5, -0.5, 1.2, -1.2, 2.0, -2.0, np.pi)  # rad about the base, tried in this order


@dataclass(frozen=True, slots=True)
class ToolKinematics:
    """The tool at one configuration.

    Attributes:
        position: (3,), m.
        R_base_tool: (3, 3) rotation.
        jacobian: (6, n), linear over angular velocity of the tool in base, per rad/s.
    """

    position: Array
    R_base_tool: Array
    jacobian: Array


class Kinematics:
    """Forward and inverse kinematics of one arm; not for use by several threads.

    Args:
        arm: which.

    Attributes:
        arm: which.
        lower, upper: joint position limits (rad).
        max_velocity: joint velocity limits (rad/s).
        R_base_tool_down: (3, 3) the tool pointing down, as it does at the home configuration.
    """

    def __init__(self, arm: ArmModel) -> None:
        self.arm = arm
        self._model = pin.buildModelFromXML(bare_text(arm.urdf))
        self._data = self._model.createData()
        self._tool = self._model.getFrameId(arm.tool_frame)
        self.lower: Array = arm.lower
        self.upper: Array = arm.upper
        self.max_velocity: Array = arm.max_velocity
        self.R_base_tool_down = self.tool(arm.home).R_base_tool
        self._heading = _heading(arm)

    @property
    def model(self) -> pin.Model:
        """The model, for those who want to compare it with another."""
        return self._model

    def tool(self, q: Array) -> ToolKinematics:
        """Pose and Jacobian of the tool at joint positions q (n,), rad."""
        jacobian = pin.computeFrameJacobian(
            self._model, self._data, q, self._tool, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        )
        pose = pin.updateFramePlacement(self._model, self._data, self._tool)
        return ToolKinematics(pose.translation.copy(), pose.rotation.copy(), jacobian)

    def gravity(self, q: Array) -> Array:
        """(n,) torques that hold the arm at q (n,), N m."""
        torques: Array = pin.computeGeneralizedGravity(self._model, self._data, q)
        return torques

    def inverse(self, position: Vector3, R_base_tool: Array, seed: Array) -> Array | None:
        """Joint positions (n,) that bring the tool there, or None; Levenberg-Marquardt from `seed` (rad)."""
        wanted = np.array(position)
        q = np.clip(seed, self.lower, self.upper)
        for _ in range(_ITERATIONS):
            tool = self.tool(q)
            away, turned = wanted - tool.position, rotation_error(R_base_tool, tool.R_base_tool)
            if np.linalg.norm(away) < POSITION_TOLERANCE and np.linalg.norm(turned) < ANGLE_TOLERANCE:
                return q
            error = np.concatenate([away, turned])
            J = tool.jacobian
            # Damping that fades with the error: calm far away and at singularities, quadratic at the end.
            damping = _DAMPING + 0.1 * float(error @ error)
            q = np.clip(
                q + J.T @ np.linalg.solve(J @ J.T + damping * np.eye(6), error), self.lower, self.upper
            )
        return None

    def inverse_tool_down(self, position: Vector3, seed: Array | None) -> Array | None:
        """Joint positions (n,) with the tool pointing as at home, or None if no start of the search leads there."""
        candidates = [] if seed is None else [seed]
        home, turn = self.arm.home, np.arctan2(position[1], position[0])
        for angle in (0.0, *(turn + np.array(_TURNS))):
            # The last joint takes back what the first turns: so the tool keeps its heading.
            candidate = home.copy()
            candidate[[0, -1]] = _wrapped(home[[0, -1]] + angle * self._heading)
            candidates.append(candidate)
        for candidate in candidates:
            q = self.inverse(position, self.R_base_tool_down, candidate)
            if q is not None:
                return q
        return None


def rotation_error(R_base_wanted: Array, R_base_tool: Array) -> Array:
    """(3,) rotation vector in base that turns the tool to where it is wanted (rad)."""
    error: Array = pin.log3(R_base_wanted @ R_base_tool.T)
    return error


def _heading(arm: ArmModel) -> Array:
    """(2,) how the first and the last joint turn so that the tool at home keeps its heading: alike, or against."""
    rotations, _ = arm.poses(arm.home)
    first, last = rotations[0] @ arm.axes[0], rotations[-1] @ arm.axes[-1]
    return np.array([1.0, 1.0 if float(first @ last) < 0.0 else -1.0])


def _wrapped(angles: Array) -> Array:
    """The same angles within -pi to pi."""
    wrapped: Array = (angles + np.pi) % (2 * np.pi) - np.pi
    return wrapped
