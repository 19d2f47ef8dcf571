"""The compiled velocity law: its parts against numpy and Pinocchio, the whole against the program it stands for."""

import daqp
import numpy as np
import pinocchio as pin
import pytest

from farhand.common.seeds import stream
from farhand.robot_side.arm.kinematics import Kinematics
from farhand.robot_side.arm.limits import JointBounds
from farhand.robot_side.arm.model import model
from farhand.robot_side.kernel import rotation, singularity
from farhand.robot_side.kernel import velocity as kernel
from farhand.robot_side.kernel.qp import BAD_INPUT, SOLVED

DT = 0.002
NONE = np.zeros(3)


class Arm:
    """A known arm, and a call of the law with its many arguments."""

    def __init__(self, name):
        self.model = model(name)
        self.n = self.model.n
        self.kinematics = Kinematics(self.model)
        self.bounds = JointBounds(self.model.lower, self.model.upper, self.model.max_velocity, 15.0)

    def jacobian(self, q):
        return np.ascontiguousarray(self.kinematics.tool(q).jacobian)

    def rotation(self, q):
        return np.ascontiguousarray(self.kinematics.tool(q).R_base_tool)

    def velocity(self, q, v, w=NONE, rows=None, sliding=False, wanted=None, box=None):
        """Status, share of the turning, joint velocities, the box."""
        low, high = box or self.bounds.at(q, np.zeros(self.n), 1.0)
        A, b = rows or (np.zeros((0, self.n)), np.zeros(0))
        qd, R = np.empty(self.n), self.rotation(q)
        status, share = kernel.velocity(
            q, self.model.home, self.jacobian(q), R, R if wanted is None else wanted, np.array(v),
            np.array(w), low, high, A, b, len(b), sliding, qd,
        )  # fmt: skip
        return status, share, qd, (low, high)


@pytest.fixture(scope="module")
def ur5():
    return Arm("ur5")


@pytest.fixture(scope="module")
def panda():
    return Arm("panda")


def near_home(arm, rng, spread):
    return np.clip(arm.model.home + rng.uniform(-spread, spread, arm.n), arm.model.lower, arm.model.upper)


@pytest.mark.parametrize("sliding", [False, True])
@pytest.mark.parametrize("turning", [False, True])
def test_it_is_the_program_that_its_docstring_names(ur5, sliding, turning):
    rng = stream(1, "velocity", f"{sliding}{turning}")
    line, price = (10.0, 100.0) if sliding else (100.0, 1.0)
    compared = 0
    for _ in range(60):
        q = near_home(ur5, rng, 0.6)
        J, v = ur5.jacobian(q), rng.uniform(-0.4, 0.4, 3)
        w = rng.uniform(-0.6, 0.6, 3) if turning else NONE
        e = rng.normal(scale=0.05, size=3)
        A, b = rng.normal(size=(3, 6)), rng.uniform(-1.0, 0.1, 3)
        wanted = pin.exp3(e) @ ur5.rotation(q)
        box = -rng.uniform(0.1, 1.0, 6), rng.uniform(0.1, 1.0, 6)
        status, _, qd, _ = ur5.velocity(q, v, w, (A, b), sliding, wanted=wanted, box=box)
        # residuals of (q', s, r): their squares are the cost
        damping = kernel.LINE_WEIGHT * max(
            singularity.escaping_damping(J, v, w + 4.0 * e), kernel.LEAST_DAMPING
        )
        blocks = [
            (line, np.column_stack([J[:3], -v, NONE]), NONE),
            (100.0, np.column_stack([J[3:], NONE, -w]), 4.0 * e),
            (price * max(v @ v, 1e-6), np.eye(8)[6:7], np.ones(1)),
            (price * max(w @ w, 1e-6), np.eye(8)[7:], np.ones(1)),
            (damping, np.eye(8)[:6], np.zeros(6)),
        ]
        H = sum(weight * M.T @ M for weight, M, _ in blocks)
        f = -sum(weight * M.T @ r for weight, M, r in blocks)
        low = np.concatenate([box[0], np.zeros(2), b])
        high = np.concatenate([box[1], np.ones(2), np.full(3, 1e30)])
        rows = np.column_stack([A, np.zeros((3, 2))])
        x, _, flag, _ = daqp.solve(H, f, rows, high, low, np.zeros(11, dtype=np.int32))
        if flag == 1 and status == SOLVED:
            compared += 1
            assert qd == pytest.approx(x[:6], abs=2e-5)
        else:
            assert status == kernel.YIELDED
    assert compared > 40


def test_a_free_arm_does_just_what_is_asked(ur5, panda):
    rng = stream(2, "velocity", "free")
    for arm in (ur5, panda):
        for _ in range(50):
            q = near_home(arm, rng, 0.4)
            v, w = rng.uniform(-0.1, 0.1, 3), rng.uniform(-0.2, 0.2, 3)
            status, share, qd, _ = arm.velocity(q, v, w)
            if singularity.escaping_damping(arm.jacobian(q), v, w) > 0.0:
                continue
            assert status == SOLVED
            assert share == pytest.approx(1.0, abs=1e-4)
            assert arm.jacobian(q) @ qd == pytest.approx(np.concatenate([v, w]), abs=1e-4)


def test_where_joints_are_too_slow_speed_and_turning_are_given_up_and_not_their_directions(ur5):
    q, v, w = ur5.model.home, np.array([0.3, 0.2, 0.1]), np.array([0.5, -0.3, 0.4])
    box = np.full(6, -0.2), np.full(6, 0.2)
    status, share, qd, _ = ur5.velocity(q, v, w, box=box)
    done = ur5.jacobian(q) @ qd
    assert status == SOLVED
    assert 0.0 < share < 0.9
    for found, asked in ((done[:3], v), (done[3:], w)):
        along = asked / np.linalg.norm(asked)
        assert 0.02 < found @ along < 0.9 * np.linalg.norm(asked)
        assert np.linalg.norm(found - (found @ along) * along) < 0.01


def test_where_it_shall_slide_it_goes_along_a_wall_that_would_stop_it(ur5):
    """A wall across the way at 45 degrees: rows keep the tool from it."""
    q, v = ur5.model.home, np.array([0.2, 0.0, 0.0])
    normal = np.array([-1.0, 1.0, 0.0]) / np.sqrt(2.0)
    rows = normal[None, :] @ ur5.jacobian(q)[:3], np.zeros(1)
    stalled, sliding = (ur5.velocity(q, v, rows=rows, sliding=flag)[2] for flag in (False, True))
    J = ur5.jacobian(q)[:3]
    for qd in (stalled, sliding):
        assert normal @ J @ qd >= -1e-9
    assert np.linalg.norm(J @ stalled) < 0.02
    assert np.linalg.norm(J @ sliding) > 0.1


def test_rows_that_cannot_all_be_kept_are_missed_least_within_the_box(ur5):
    q = ur5.model.home
    J = ur5.jacobian(q)[:3]
    rows = np.array([J[0], -J[0]]), np.array([0.1, 0.1])
    status, _, qd, (low, high) = ur5.velocity(q, [0.0, 0.2, 0.0], rows=rows, sliding=True)
    assert status == kernel.YIELDED
    assert J[0] @ qd == pytest.approx(0.0, abs=1e-6)
    assert np.all((low <= qd) & (qd <= high))


def test_damping_is_that_of_the_singular_values(ur5, panda):
    rng = stream(3, "velocity", "damping")
    damped = 0
    for arm in (ur5, panda):
        for _ in range(200):
            q = rng.uniform(-2.0, 2.0, arm.n) * (rng.random(arm.n) > 0.2)  # some right in a singularity
            J, twist = arm.jacobian(q), rng.normal(size=6)
            U, values, Vt = np.linalg.svd(J, full_matrices=False)
            left, right, way = np.empty(6), np.empty(arm.n), np.zeros(max(arm.n, 6))
            way[:6] = twist
            assert singularity.singular(J, left, right, way) == pytest.approx(values[-1], abs=1e-12)
            assert np.linalg.norm(left) == pytest.approx(1.0)
            assert np.linalg.norm(right) == pytest.approx(1.0)
            assert np.abs(left @ J - values[-1] * right).max() < 1e-9
            if values[-2] > 1e-3 and values[-1] > 1e-7:
                assert way == pytest.approx(
                    Vt.T @ ((U.T @ twist) / np.maximum(values, 1e-4)), rel=1e-6, abs=1e-6
                )
            found = singularity.escaping_damping(J, twist[:3], twist[3:])
            if values[-1] >= singularity.SINGULAR_BELOW:
                assert found == 0.0
            else:
                damped += 1
                assert (
                    0.0
                    <= found
                    <= singularity.damping_of(values[-1]) + 1e-12
                    <= singularity.MAX_DAMPING**2 + 1e-12
                )
    assert damped > 50


@pytest.mark.parametrize("name", ["ur5", "panda"])
def test_the_gradient_of_the_smallest_singular_value(name):
    arm, rng = Arm(name), stream(4, "configurations")
    smallest = lambda q: np.linalg.svd(arm.jacobian(q), compute_uv=False)[-1]  # noqa: E731
    for _ in range(20):
        q = rng.uniform(-2.0, 2.0, arm.n)
        U, _, Vt = np.linalg.svd(arm.jacobian(q), full_matrices=False)
        found = np.empty(arm.n)
        singularity.singular_value_gradient(
            arm.jacobian(q), np.ascontiguousarray(U[:, -1]), np.ascontiguousarray(Vt[-1]), found
        )
        steps = 1e-6 * np.eye(arm.n)
        assert found == pytest.approx([(smallest(q + s) - smallest(q - s)) / 2e-6 for s in steps], abs=1e-6)


def test_rotations_are_pinocchios():
    rng = stream(5, "velocity", "rotations")
    for angle in (0.0, 1e-9, 1e-4, 0.3, 2.0, 3.1, np.pi - 1e-9, np.pi):
        for _ in range(20):
            axis = rng.normal(size=3)
            e = angle * axis / np.linalg.norm(axis)
            R = pin.exp3(rng.normal(size=3))
            out, found = np.empty((3, 3)), np.empty(3)
            rotation.turn_by(R, e, out)
            assert out == pytest.approx(pin.exp3(e) @ R, abs=1e-12)
            rotation.rotation_vector(out, R, found)
            if angle > 3.14:
                assert pin.exp3(found) == pytest.approx(pin.exp3(e), abs=1e-6)
            else:
                assert found == pytest.approx(e, abs=1e-10)


def test_an_arm_that_cannot_follow_does_not_wind_its_orientation_up():
    wanted, tool = np.eye(3), np.eye(3)
    for _ in range(1000):
        rotation.turn_wanted(wanted, tool, np.array([0.0, 0.0, 1.0]), 0.01)
    assert pin.log3(wanted) == pytest.approx((0.0, 0.0, rotation.LEAD))
    kept = wanted.copy()
    rotation.turn_wanted(wanted, tool, NONE, 0.01)
    assert np.array_equal(wanted, kept)


def test_seven_joints_go_home_while_the_tool_moves_and_stand_while_it_stands(panda):
    q, v = near_home(panda, stream(6, "velocity", "posture"), 0.3), np.array([0.0, 0.1, 0.0])
    J = panda.jacobian(q)
    free = np.linalg.svd(J)[2][-1]
    way = panda.model.home - q
    moving, standing = panda.velocity(q, v)[2], panda.velocity(q, NONE)[2]
    assert np.abs(standing).max() < 1e-6
    assert (free @ moving) * (free @ way) > 0.0
    assert abs(free @ moving) == pytest.approx(kernel.POSTURE_GAIN * abs(free @ way), rel=0.05)
    assert J @ moving == pytest.approx(np.concatenate([v, NONE]), abs=1e-4)


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_nonsense_brakes(ur5, value):
    q, previous = ur5.model.home, np.full(6, 0.5)
    box = ur5.bounds.at(q, previous, DT)
    for v, w in (([value, 0.0, 0.0], NONE), ([0.1, 0.0, 0.0], np.array([0.0, value, 0.0]))):
        status, _, qd, _ = ur5.velocity(q, v, w, box=box)
        assert status == BAD_INPUT
        assert qd == pytest.approx(previous - 15.0 * DT)
    rows = np.full((1, 6), value), np.zeros(1)
    status, _, qd, _ = ur5.velocity(q, [0.1, 0.0, 0.0], rows=rows, box=box)
    assert status == BAD_INPUT
    assert qd == pytest.approx(previous - 15.0 * DT)
    status, _, qd, _ = ur5.velocity(q, [0.1, 0.0, 0.0], box=(np.full(6, value), np.full(6, value)))
    assert status == BAD_INPUT
    assert np.isfinite(qd).all()
