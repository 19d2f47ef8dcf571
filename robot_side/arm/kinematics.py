"""Kinematics of the UR5 by Pinocchio: base to tool0, everything expressed in the base frame."""

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from farhand.common.geometry import Array
from farhand.common.messages.base import Vector3
from farhand.robot_side.arm.model import HOME, TOOL_FRAME, urdf_path

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
        jacobian: (6, 6), linear over angular velocity of the tool in base, per rad/s.
    """

    position: Array
    R_base_tool: Array
    jacobian: Array


class Kinematics:
    """Forward and inverse kinematics of one arm; not for use by several threads.

    Attributes:
        lower, upper: joint position limits (rad).
        max_velocity: joint velocity limits (rad/s).
        R_base_tool_down: (3, 3) the tool pointing down, as it does at the home configuration.
    """

    def __init__(self) -> None:
        self._model = pin.buildModelFromUrdf(str(urdf_path()))
        self._data = self._model.createData()
        self._tool = self._model.getFrameId(TOOL_FRAME)
        self.lower: Array = np.array(self._model.lowerPositionLimit)
        self.upper: Array = np.array(self._model.upperPositionLimit)
        self.max_velocity: Array = np.array(self._model.velocityLimit)
        self.R_base_tool_down = self.tool(np.array(HOME)).R_base_tool

    @property
    def model(self) -> pin.Model:
        """The model, for those who want to compare it with another."""
        return self._model

    def tool(self, q: Array) -> ToolKinematics:
        """Pose and Jacobian of the tool at joint positions q (6,), rad."""
        jacobian = pin.computeFrameJacobian(
            self._model, self._data, q, self._tool, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        )
        pose = pin.updateFramePlacement(self._model, self._data, self._tool)
        return ToolKinematics(pose.translation.copy(), pose.rotation.copy(), jacobian)

    def inverse(self, position: Vector3, R_base_tool: Array, seed: Array) -> Array | None:
        """Joint positions (6,) that bring the tool there, or None; Levenberg-Marquardt from `seed` (rad)."""
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
        """Joint positions (6,) with the tool pointing down, or None if no start of the search leads there."""
        candidates = [] if seed is None else [seed]
        home, turn = np.array(HOME), np.arctan2(position[1], position[0])
        for angle in (0.0, *(turn + np.array(_TURNS))):
            # The first and the last joint turn together: so the tool keeps its heading.
            candidate = home.copy()
            candidate[[0, 5]] = _wrapped(home[[0, 5]] + angle)
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


def _wrapped(angles: Array) -> Array:
    """The same angles within -pi to pi."""
    wrapped: Array = (angles + np.pi) % (2 * np.pi) - np.pi
    return wrapped
