"""Forward kinematics of a serial chain of revolute joints: every joint's frame, the tool and its Jacobian.

Arrays:
    chain: (n + 1, 15) from `pack`; row i places joint i in the frame of the joint before it (rotation row by row, 9;
        position, 3; axis in its own frame, 3), row n the tool in the last joint's frame.
    R: (n, 3, 3), p: (n, 3) the joints' frames in base, turned by q (m).
    R_tool: (3, 3), p_tool: (3,) the tool in base.
    J: (6, n) linear over angular velocity of the tool in base, per rad/s.
    placed: (18 n + 25,) R, p, R_tool, p_tool, J and the tool's state one after the other, see `parts`: to hand over one
        array costs less than to hand over six.
"""

# mypy: allow-untyped-defs, allow-untyped-calls, allow-untyped-decorators
# numba infers the types from the arrays listed above

import numpy as np

from farhand.common.geometry import Array
from farhand.robot_side.kernel.jit import compiled


def pack(
    R_parent_joint: Array, p_parent_joint: Array, axes: Array, R_last_tool: Array, p_last_tool: Array
) -> Array:
    """The chain as one array.

    Args:
        R_parent_joint, p_parent_joint: (n, 3, 3), (n, 3) placement of each joint in the frame of the one before (m).
        axes: (n, 3) unit vectors in the joints' own frames.
        R_last_tool, p_last_tool: (3, 3), (3,) placement of the tool in the last joint's frame (m).
    """
    n = len(axes)
    chain = np.zeros((n + 1, 15))
    chain[:n, :9] = np.reshape(R_parent_joint, (n, 9))
    chain[:n, 9:12] = p_parent_joint
    chain[:n, 12:] = axes
    chain[n, :9] = np.ravel(R_last_tool)
    chain[n, 9:12] = p_last_tool
    return chain


@compiled
def place(R_before, p_before, row, R, p):
    """R, p = the frame that `row` of a chain places in the frame R_before, p_before; not turned yet."""
    for i in range(3):
        p[i] = p_before[i]
        for k in range(3):
            p[i] += R_before[i, k] * row[9 + k]
            R[i, k] = R_before[i, 0] * row[k] + R_before[i, 1] * row[3 + k] + R_before[i, 2] * row[6 + k]


@compiled
def turn(R, axis, angle):
    """R <- R exp(angle axis^), in place; `axis` (3,) is a unit vector in R's own frame."""
    c, s = np.cos(angle), np.sin(angle)
    x, y, z = axis[0], axis[1], axis[2]
    v = 1.0 - c
    for i in range(3):
        a, b, d = R[i, 0], R[i, 1], R[i, 2]
        R[i, 0] = a * (c + v * x * x) + b * (v * x * y + s * z) + d * (v * x * z - s * y)
        R[i, 1] = a * (v * x * y - s * z) + b * (c + v * y * y) + d * (v * y * z + s * x)
        R[i, 2] = a * (v * x * z + s * y) + b * (v * y * z - s * x) + d * (c + v * z * z)


@compiled
def forward(chain, q, R, p, R_tool, p_tool, J):
    """Fill R, p, R_tool, p_tool and J at joint positions q (n,), rad."""
    n = q.shape[0]
    base = np.eye(3)
    origin = np.zeros(3)
    for i in range(n):
        if i == 0:
            place(base, origin, chain[0], R[0], p[0])
        else:
            place(R[i - 1], p[i - 1], chain[i], R[i], p[i])
        turn(R[i], chain[i, 12:], q[i])
    place(R[n - 1], p[n - 1], chain[n], R_tool, p_tool)
    point_jacobian(chain, R, p, n, p_tool, J)


@compiled
def point_jacobian(chain, R, p, joints, point, J):
    """Fill J (6, n) for a point (3,) that moves with the joint before number `joints`; later columns are 0."""
    for i in range(J.shape[1]):
        if i >= joints:
            for k in range(6):
                J[k, i] = 0.0
            continue
        for k in range(3):
            J[3 + k, i] = R[i, k, 0] * chain[i, 12] + R[i, k, 1] * chain[i, 13] + R[i, k, 2] * chain[i, 14]
        x, y, z = point[0] - p[i, 0], point[1] - p[i, 1], point[2] - p[i, 2]
        J[0, i] = J[4, i] * z - J[5, i] * y
        J[1, i] = J[5, i] * x - J[3, i] * z
        J[2, i] = J[3, i] * y - J[4, i] * x


@compiled
def tool_state(R_tool, p_tool, J, qd, out):
    """Fill out (13,): position (m), velocity (m/s), orientation (w, x, y, z), angular velocity (rad/s), in base."""
    for k in range(3):
        out[k] = p_tool[k]
        out[3 + k], out[10 + k] = 0.0, 0.0
        for i in range(qd.shape[0]):
            out[3 + k] += J[k, i] * qd[i]
            out[10 + k] += J[3 + k, i] * qd[i]
    trace = R_tool[0, 0] + R_tool[1, 1] + R_tool[2, 2]
    if trace > 0.0:
        t = np.sqrt(trace + 1.0)
        out[6] = 0.5 * t
        t = 0.5 / t
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            out[7 + i] = (R_tool[k, j] - R_tool[j, k]) * t
        return
    i = 0
    if R_tool[1, 1] > R_tool[0, 0]:
        i = 1
    if R_tool[2, 2] > R_tool[i, i]:
        i = 2
    j, k = (i + 1) % 3, (i + 2) % 3
    t = np.sqrt(R_tool[i, i] - R_tool[j, j] - R_tool[k, k] + 1.0)
    out[7 + i] = 0.5 * t
    t = 0.5 / t
    out[6] = (R_tool[k, j] - R_tool[j, k]) * t
    out[7 + j] = (R_tool[j, i] + R_tool[i, j]) * t
    out[7 + k] = (R_tool[k, i] + R_tool[i, k]) * t


@compiled
def parts(placed, n):
    """R, p, R_tool, p_tool, J and the tool's state (13,), each of them a part of `placed` and not a copy."""
    p, tool = 9 * n, 12 * n
    J = tool + 12
    out = J + 6 * n
    return (
        placed[:p].reshape((n, 3, 3)),
        placed[p:tool].reshape((n, 3)),
        placed[tool : tool + 9].reshape((3, 3)),
        placed[tool + 9 : J],
        placed[J:out].reshape((6, n)),
        placed[out : out + 13],
    )


@compiled
def moving_tool(chain, joints, placed):
    """Fill `placed` at joint positions and velocities (2 n,): `forward`, and of the tool `tool_state`."""
    n = joints.shape[0] // 2
    R, p, R_tool, p_tool, J, out = parts(placed, n)
    forward(chain, joints[:n], R, p, R_tool, p_tool, J)
    tool_state(R_tool, p_tool, J, joints[n:], out)
