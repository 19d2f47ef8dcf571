"""The compiled kinematics against Pinocchio's, and its Jacobian against differences of its own."""

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from farhand.common.seeds import stream
from farhand.robot_side.arm.model import model
from farhand.robot_side.kernel.chain import forward, pack, point_jacobian, tool_state


def room(n):
    """Arrays that `forward` fills."""
    return np.empty((n, 3, 3)), np.empty((n, 3)), np.empty((3, 3)), np.empty(3), np.empty((6, n))


class Both:
    """A known arm for Pinocchio and for the kernel."""

    def __init__(self, name):
        arm = model(name)
        self.n = arm.n
        self.pinocchio = pin.buildModelFromXML(arm.urdf)
        self.data = self.pinocchio.createData()
        self.frame = self.pinocchio.getFrameId(arm.tool_frame)
        self.chain = pack(arm.R_parent_joint, arm.p_parent_joint, arm.axes, arm.R_last_tool, arm.p_last_tool)


ARMS = {name: Both(name) for name in ("ur5", "panda")}


@pytest.mark.parametrize("name", list(ARMS))
@settings(max_examples=100, deadline=None)
@given(st.lists(st.floats(-7.0, 7.0), min_size=7, max_size=7))
def test_known_arms_are_pinocchios(name, q):
    both = ARMS[name]
    q = np.array(q[: both.n])
    R, p, R_tool, p_tool, J = room(both.n)
    forward(both.chain, q, R, p, R_tool, p_tool, J)
    expected = pin.computeFrameJacobian(
        both.pinocchio, both.data, q, both.frame, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
    )
    pose = pin.updateFramePlacement(both.pinocchio, both.data, both.frame)
    assert np.abs(J - expected).max() < 1e-12
    assert np.abs(R_tool - pose.rotation).max() < 1e-12
    assert np.abs(p_tool - pose.translation).max() < 1e-12
    for i in range(both.n):
        assert np.abs(R[i] - both.data.oMi[i + 1].rotation).max() < 1e-12
        assert np.abs(p[i] - both.data.oMi[i + 1].translation).max() < 1e-12


def any_chain(rng, n):
    """Joints about any axes."""
    axes = rng.normal(size=(n, 3))
    turns = [pin.exp3(rng.normal(size=3)) for _ in range(n + 1)]
    return pack(
        np.array(turns[:n]),
        rng.normal(scale=0.3, size=(n, 3)),
        axes / np.linalg.norm(axes, axis=1, keepdims=True),
        turns[n],
        rng.normal(scale=0.1, size=3),
    )


@pytest.mark.parametrize("n", [1, 4, 6, 7])
def test_the_jacobian_is_the_derivative_about_any_axes(n):
    rng = stream(1, "chain", str(n))
    for _ in range(20):
        chain, q = any_chain(rng, n), rng.uniform(-3, 3, n)
        R, p, R_tool, p_tool, J = room(n)
        forward(chain, q, R, p, R_tool, p_tool, J)
        assert np.allclose(R_tool @ R_tool.T, np.eye(3), atol=1e-12)
        for i in range(n):
            step = np.zeros(n)
            step[i] = 1e-6
            ends = []
            for sign in (1.0, -1.0):
                _, _, R_end, p_end, other = room(n)
                forward(chain, q + sign * step, np.empty((n, 3, 3)), np.empty((n, 3)), R_end, p_end, other)
                ends.append((R_end, p_end))
            assert J[:3, i] == pytest.approx((ends[0][1] - ends[1][1]) / 2e-6, abs=1e-8)
            assert J[3:, i] == pytest.approx(pin.log3(ends[0][0] @ ends[1][0].T) / 2e-6, abs=1e-8)


def test_a_point_on_a_link_moves_with_the_joints_before_it_only():
    rng = stream(2, "chain", "point")
    chain, q, link = any_chain(rng, 6), rng.uniform(-3, 3, 6), 3
    R, p, R_tool, p_tool, J = room(6)
    forward(chain, q, R, p, R_tool, p_tool, J)
    local = rng.normal(size=3)
    place = lambda: p[link] + R[link] @ local  # noqa: E731
    point_jacobian(chain, R, p, link + 1, place(), J)
    found = J.copy()
    assert not found[:, link + 1 :].any()
    for i in range(6):
        step = np.zeros(6)
        step[i] = 1e-6
        forward(chain, q + step, R, p, R_tool, p_tool, J)
        there = place()
        forward(chain, q - step, R, p, R_tool, p_tool, J)
        assert found[:3, i] == pytest.approx((there - place()) / 2e-6, abs=1e-8)


def test_the_state_of_the_tool_is_eigens_to_the_sign():
    rng = stream(3, "chain", "state")
    for _ in range(200):
        turn = rng.normal(size=3)
        R = pin.exp3(np.pi * turn / np.linalg.norm(turn) * rng.uniform(0, 2))
        p, J, qd = rng.normal(size=3), rng.normal(size=(6, 7)), rng.normal(size=7)
        out = np.empty(13)
        tool_state(R, p, J, qd, out)
        x, y, z, w = pin.Quaternion(R).coeffs()
        assert out == pytest.approx([*p, *(J[:3] @ qd), w, x, y, z, *(J[3:] @ qd)], abs=1e-12)
