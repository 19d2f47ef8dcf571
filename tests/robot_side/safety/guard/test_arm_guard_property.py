"""The guard of arms: hostile commands never bring a link too near, and what stands never makes it faster."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from farhand.common.geometry import to_vector3
from farhand.common.shapes.box import Box
from farhand.common.shapes.obstacle import Obstacle
from farhand.common.shapes.plane import Plane
from farhand.common.shapes.sphere import Sphere
from farhand.robot_side.arm.model import model
from farhand.robot_side.kernel.distance import PLANE, capsule_row
from farhand.robot_side.safety.guard.arm_guard import ArmGuard, Joints, placed, self_gaps
from farhand.robot_side.safety.guard.settings import GuardSettings
from farhand.robot_side.scene.surroundings import surroundings_of
from farhand.trials.safety.adversary import MODES
from farhand.trials.safety.arm_run import run_arm
from farhand.trials.safety.outcome import Case

DT, D_MIN = 0.002, 0.01
UR5 = model("ur5")
ELBOW = Obstacle(id="elbow", position=(0.2, 0.0, 0.72), shape=Sphere(0.08))
CRATE = Obstacle(id="crate", position=(0.45, 0.25, 0.15), shape=Box((0.15, 0.1, 0.15)))
TABLE = Obstacle(id="table", position=(0.0, 0.0, 0.0), shape=Plane())
_errors = st.sampled_from((-0.5, 0.0, 0.5))


def _guard():
    return ArmGuard(UR5, GuardSettings(d_min=D_MIN), 0.016, DT)


def _clearance(guard, q, around):
    A, B = placed(guard.body, q)
    return min(
        capsule_row(A[i], B[i], guard.body.capsules[i, 7], row, around.vertices)[0]
        for i in range(2, guard.body.whole)
        for row in around.rows
        if not (i == 2 and row[0] == PLANE)  # its foot stands 5 mm over the table, and cannot leave it
    )


def _drive(guard, around, twists, ticks):
    """Joints that do as they are told, from home; the states: (q, qd, v asked, v done)."""
    q, qd = UR5.home.copy(), np.zeros(6)
    wanted = np.ascontiguousarray(UR5.tool_pose(q)[0])
    states = []
    for twist in twists:
        v, w = np.array(twist[:3]), np.array(twist[3:])
        for _ in range(ticks):
            new = guard.command(Joints(q, qd, qd), v, w, wanted, around).copy()
            states.append((q, qd, new))
            q, qd = q + DT * new, new
    return states


@settings(max_examples=12, deadline=None, derandomize=True)
@given(
    robot=st.sampled_from(("ur5", "panda")),
    index=st.integers(0, 10_000),
    mode=st.sampled_from(MODES),
    lag=_errors,
    acceleration=_errors,
)
def test_hostile_commands_in_any_scene(robot, index, mode, lag, acceleration):
    case = Case(
        robot=robot, index=index, scene=index, speed=0.0, mode=mode, lag_error=lag,
        acceleration_error=acceleration, duration=1.5,
    )  # fmt: skip
    outcome = run_arm(3, case, GuardSettings(d_min=D_MIN))
    assert not outcome.violates(D_MIN), outcome


def test_without_it_the_same_commands_collide():
    case = Case(
        robot="ur5", index=5, scene=1, speed=0.0, mode="nearest", lag_error=0.0, acceleration_error=0.0, duration=1.5,
        guarded=False,
    )  # fmt: skip
    assert run_arm(3, case, GuardSettings(d_min=D_MIN)).nearest < 0.0


_speeds = st.floats(-1.0, 1.0)


@settings(max_examples=15, deadline=None, derandomize=True)
@given(twists=st.lists(st.tuples(*[_speeds] * 6), min_size=1, max_size=4))
def test_any_commands_keep_distance_limits_and_acceleration(twists):
    guard, around = _guard(), surroundings_of([ELBOW, CRATE, TABLE])
    for q, qd, new in _drive(guard, around, twists, 150):
        assert _clearance(guard, q, around) >= D_MIN
        assert self_gaps(guard.body, q).min() >= D_MIN
        assert (np.abs(new - qd) <= UR5.max_acceleration * DT + 1e-9).all()
        assert (np.abs(new) <= UR5.max_velocity + 1e-9).all()
        assert ((q >= UR5.lower - 1e-6) & (q <= UR5.upper + 1e-6)).all()
    assert guard.failures == 0


def test_what_stands_never_moves_an_arm_that_is_asked_for_nothing():
    guard = _guard()
    A, B = placed(guard.body, UR5.home)
    top = 0.5 * (A[3] + B[3]) + np.array([0.0, 0.0, guard.body.capsules[3, 7]])
    touching = Obstacle(
        id="post", position=to_vector3((top + np.array([0.0, 0.0, 0.055])).tolist()), shape=Sphere(0.05)
    )
    around = surroundings_of([touching, TABLE])
    for _, _, new in _drive(guard, around, [(0.0,) * 6], 50):
        assert np.abs(new).max() < 1e-9


def test_it_steps_aside_from_what_moves_towards_it():
    guard = _guard()
    A, B = placed(guard.body, UR5.home)
    elbow = 0.5 * (A[3] + B[3])
    around = surroundings_of([Obstacle(id="ball", position=(0.0, 0.0, 0.0), shape=Sphere(0.06))])
    q, qd = UR5.home.copy(), np.zeros(6)
    wanted, still = np.ascontiguousarray(UR5.tool_pose(q)[0]), np.zeros(3)
    evaded = False
    for tick in range(1000):
        around.move(0, (elbow + np.array([0.0, 0.0, 0.5 - 0.2 * tick * DT])).tolist(), (0.0, 0.0, -0.2))
        assert _clearance(guard, q, around) >= D_MIN
        qd = guard.command(Joints(q, qd, qd), still, still, wanted, around).copy()
        q = q + DT * qd
        evaded = evaded or (guard.did is not None and guard.did.what == "evading")
    assert evaded


def test_it_names_part_and_obstacle():
    guard, around = _guard(), surroundings_of([CRATE])
    _drive(guard, around, [(0.0, 0.3, -0.1, 0.0, 0.0, 0.0)], 800)
    did = guard.did
    assert did is not None
    assert did.part.startswith("wrist")
    assert did.obstacle == "crate"
    assert D_MIN < did.distance < 0.05
    assert did.done < did.asked == pytest.approx(np.hypot(0.3, 0.1))
    assert did.limit == pytest.approx(0.01)  # as the scenario has it, and the summary


def test_a_halt_brakes_all_joints_together():
    guard = _guard()
    qd = np.array([2.0, -1.0, 0.5, 0.0, 0.1, 0.0])
    for _ in range(200):
        new = guard.halt(qd).copy()
        assert (np.abs(new - qd) <= UR5.max_acceleration * DT + 1e-9).all()
        if np.abs(new).max() > 1e-6:
            assert new / np.abs(new).max() == pytest.approx(np.array([2.0, -1.0, 0.5, 0.0, 0.1, 0.0]) / 2.0)
        qd = new
    assert np.abs(qd).max() < 1e-6


@pytest.mark.parametrize("name", ["ur3", "ur5", "ur10", "panda"])
def test_the_reach_of_every_capsule_is_never_less_than_true(name):
    arm = model(name)
    body = ArmGuard(arm, GuardSettings(), 0.016, DT).body
    rng = np.random.default_rng(1)
    for _ in range(50):
        q = rng.uniform(arm.lower, arm.upper)
        rotations, origins = arm.poses(q)
        ends = np.stack(placed(body, q), axis=1)
        for i, joint in enumerate(body.capsules[:, 0].astype(int)):
            for k in range(joint + 1):
                off = np.cross(rotations[k] @ arm.axes[k], ends[i] - origins[k])
                far = np.linalg.norm(off, axis=1).max() + body.capsules[i, 7]
                assert far <= body.reach[i, k] + 1e-9
