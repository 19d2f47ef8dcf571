"""From a tool velocity to joint velocities: the interface, and the law that keeps the direction.

A small quadratic program in (q', s), solved at every control period:

    min  100 |J_lin q' - s v|^2 + 100 |J_ang q' - w|^2 + |v|^2 (1 - s)^2 + damping |q'|^2
    s.t. 0 <= s <= 1,  q' within JointBounds,

w = w_c + 4 log3(R_d R^T), w_c the commanded turning, which R_d follows (orientation.py). Where the arm cannot
follow it gives up speed (s) before it gives up direction, so that near singularities and limits the tool stays on
the commanded line. Damping holds back what drives further into a singularity, and not what leads out of it: there
it would outweigh the speed a thousandfold, and the arm would stick (see `escape`).
"""

from typing import Protocol

import daqp
import numpy as np

from farhand.common.geometry import Array
from farhand.robot_side.arm.kinematics import ToolKinematics, rotation_error
from farhand.robot_side.arm.limits import JointBounds

ORIENTATION_GAIN = 4.0  # 1/s
LINE_WEIGHT = 100.0
ORIENTATION_WEIGHT = 100.0
SINGULAR_BELOW = 0.08  # smallest singular value of the Jacobian under which damping sets in
MAX_DAMPING = 0.05
PLAIN = 0.2
"""Cosine to the gradient of the smallest singular value from which a motion leads out of a singularity plainly."""
_LEAST_SPEED_WEIGHT = 1e-6
_REST = 1e-5
"""Damping of an arm with more than six joints: of all motions that do the same to the tool, the least."""
_NO_TURN: Array = np.zeros(3)


class VelocityControl(Protocol):
    """A law from a twist of the tool to joint velocities. Nothing throws.

    Attributes:
        R_base_wanted: (3, 3) orientation that the tool keeps; assign to it to turn the tool.
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
            tool: kinematics at q.
            v_tool_in_base: (3,) wanted tool velocity (m/s).
            dt: control period (s).
            omega_in_base: (3,) commanded angular velocity of the tool (rad/s).
        """
        ...


class DirectionKeeping:
    """The quadratic program above, by daqp.

    Args:
        bounds: of the joint velocities.
        R_base_wanted: (3, 3) orientation that the tool keeps.

    Attributes:
        failures: solves that did not end well; the arm brakes then.
    """

    def __init__(self, bounds: JointBounds, R_base_wanted: Array) -> None:
        self._bounds = bounds
        self.R_base_wanted = R_base_wanted
        n = self._n = bounds.n
        self._H = np.zeros((n + 1, n + 1))
        self._f = np.zeros(n + 1)
        self._low, self._high = np.zeros(n + 1), np.ones(n + 1)
        self._no_rows = np.zeros((0, n + 1))
        self._sense = np.zeros(n + 1, dtype=np.int32)
        self.failures = 0

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
        J_lin, J_ang = tool.jacobian[:3], tool.jacobian[3:]
        v = v_tool_in_base
        speed_squared = float(v @ v)
        speed_weight = max(speed_squared, _LEAST_SPEED_WEIGHT)
        H, f, n = self._H, self._f, self._n
        H[:n, :n] = LINE_WEIGHT * (J_lin.T @ J_lin) + ORIENTATION_WEIGHT * (J_ang.T @ J_ang)
        H[range(n), range(n)] += LINE_WEIGHT * escaping_damping(tool.jacobian, np.concatenate([v, omega]))
        H[range(n), range(n)] += _REST if n > 6 else 0.0
        H[:n, n] = H[n, :n] = -LINE_WEIGHT * (J_lin.T @ v)
        H[n, n] = LINE_WEIGHT * speed_squared + speed_weight
        f[:n] = -ORIENTATION_WEIGHT * (J_ang.T @ omega)
        f[n] = -speed_weight
        self._low[:n], self._high[:n] = low, high
        x, _, flag, _ = daqp.solve(H, f, self._no_rows, self._high, self._low, self._sense)
        if flag <= 0 or not np.isfinite(x).all():
            self.failures += 1
            return np.clip(np.zeros(n), low, high)
        limited: Array = np.clip(x[:n], low, high)
        return limited


class DampedLeastSquares:
    """The plain baseline: q' = J^T (J J^T + damping I)^-1 (v, w), scaled into the velocity limits.

    Args:
        bounds: of the joint velocities; what exceeds them is cut, which bends the path.
        max_velocity: (n,) rad/s.
        R_base_wanted: (3, 3) orientation that the tool keeps.
    """

    def __init__(self, bounds: JointBounds, max_velocity: Array, R_base_wanted: Array) -> None:
        self._bounds = bounds
        self._max_velocity = max_velocity
        self.R_base_wanted = R_base_wanted

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
        least = _LEAST_SPEED_WEIGHT + damping(J)
        qd = J.T @ np.linalg.solve(J @ J.T + least * np.eye(6), np.concatenate([v_tool_in_base, omega]))
        excess = float(np.max(np.abs(qd) / self._max_velocity))
        return np.clip(qd / max(1.0, excess), low, high)


def damping(jacobian: Array) -> float:
    """0 where the arm is well conditioned, rising to MAX_DAMPING^2 where it is singular."""
    return _damping_at(float(np.linalg.svd(jacobian, compute_uv=False)[-1]))


def escaping_damping(jacobian: Array, twist: Array) -> float:
    """`damping`, taken back as far as the wanted motion leads out of the singularity.

    Args:
        jacobian: (6, n) of the tool in base, linear over angular.
        twist: (6,) that is wanted, linear over angular (m/s, rad/s).
    """
    U, singular, Vt = np.linalg.svd(jacobian, full_matrices=False)
    if singular[-1] >= SINGULAR_BELOW or not np.isfinite(twist).all():
        return _damping_at(float(singular[-1]))
    # Straight out of the singular values: the singular direction decides, as it alone needs fast joints.
    qd = Vt.T @ ((U.T @ twist) / np.maximum(singular, 1e-4))
    return _damping_at(float(singular[-1])) * (1.0 - escape(jacobian, U[:, -1], Vt[-1], qd))


def escape(jacobian: Array, left: Array, right: Array, qd: Array) -> float:
    """How plainly joint velocities lead out of a singularity: 0 (not at all, or along it) to 1.

    The smallest singular value changes at u^T dJ/dt w, u and w its singular vectors. For revolute joints column i
    of J changes with joint j by (z_j x J_lin,i; z_j x z_i) if j <= i, else by (z_i x J_lin,j; 0), z_i = J_ang,i:
    so its gradient takes nothing but J. Returned is the cosine between gradient and qd over PLAIN, within 0 and 1.

    Args:
        jacobian: (6, n) of the tool in base, linear over angular.
        left, right: (6,), (n,) singular vectors of the smallest singular value.
        qd: (n,) rad/s.
    """
    gradient = singular_value_gradient(jacobian, left, right)
    scale = float(np.linalg.norm(gradient) * np.linalg.norm(qd))
    if scale <= 0.0:
        return 0.0
    return float(np.clip(gradient @ qd / (PLAIN * scale), 0.0, 1.0))


def singular_value_gradient(jacobian: Array, left: Array, right: Array) -> Array:
    """(n,) derivatives of the singular value with vectors `left` (6,), `right` (n,) by the joint positions."""
    lin, axes = jacobian[:3].T, jacobian[3:].T
    # What lies after a joint turns with it; what lies before sees the tool shifted by it.
    turned = _sums_from(lin * right[:, None])
    axes_after = _sums_from(axes * right[:, None])
    axes_before = axes_after[0] - axes_after
    # a . (b x c) = c . (a x b)
    gradient: Array = np.einsum("jk,jk->j", turned, _cross(left[:3], axes)) + (
        np.einsum("jk,jk->j", axes_after, _cross(left[3:], axes))
        - np.einsum("jk,jk->j", axes_before, _cross(left[:3], lin))
    )
    return gradient


def _sums_from(rows: Array) -> Array:
    """Row j: the sum of rows j and after."""
    sums: Array = np.cumsum(rows[::-1], axis=0)[::-1]
    return sums


def _cross(a: Array, b: Array) -> Array:
    """(n, 3): a x each row of b; ten times faster than numpy's for so few."""
    x, y, z = a
    product: Array = b @ np.array([[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]])
    return product


def _damping_at(smallest: float) -> float:
    if smallest >= SINGULAR_BELOW:
        return 0.0
    return MAX_DAMPING**2 * (1.0 - (smallest / SINGULAR_BELOW) ** 2)
