"""An arm that is told to fold onto itself stops before two of its links meet, whatever its SRDF says of them."""

import dataclasses

import numpy as np
import pytest

from farhand.robot_side.arm.model import model
from farhand.robot_side.safety.guard.arm_guard import ArmGuard, Joints, body_of, self_gaps
from farhand.robot_side.safety.guard.settings import GuardSettings
from farhand.robot_side.scene.surroundings import surroundings_of
from farhand.trials.safety.arm_run import KinematicArm
from farhand.trials.safety.truth import Meshes

DT, LAG, D_MIN = 0.002, 0.016, 0.01
# joint velocities (rad/s), and which links they would bring together
FOLDS = {
    "ur3": ((0, 0, 0, 1.5, -1.0, 0), ("forearm_link", "wrist_3_link")),
    "ur5": ((0, 0, 0, 1.5, -1.0, 0), ("forearm_link", "wrist_2_link")),
    "ur10": ((0, 0, 0, 1.5, -1.0, 0), ("forearm_link", "wrist_3_link")),
    "ur5 lowered": ((0, 1.5, -1.5, 0, 0, 0), ("base_link", "upper_arm_link")),
    "panda": ((0, 0, 0, 0, 0, -0.5, 1.0), ("panda_link5", "panda_link7")),
}


def _least(arm, asked, one, other):
    """Least distance of two links of an arm whose joints brake half as well as they say (m)."""
    guard, meshes = ArmGuard(arm, GuardSettings(d_min=D_MIN), LAG, DT), Meshes(arm)
    body = KinematicArm(arm.home, LAG, 0.5 * arm.max_acceleration)
    wanted, still, nothing = np.eye(3), np.zeros(3), surroundings_of([])
    commanded, least = np.zeros(arm.n), 1.0
    for tick in range(2000):
        new = guard.command(Joints(body.q, body.qd, commanded), still, still, wanted, nothing, asked)
        commanded = new.copy()
        body.step(commanded)
        if tick % 10 == 0:
            meshes.place(body.q)
            least = min(least, meshes.between(one, other, 0.03))
            if least <= 0.0:
                break
    return least


@pytest.mark.parametrize("fold", list(FOLDS))
def test_links_stop_before_they_meet(fold):
    asked, (one, other) = FOLDS[fold]
    arm, velocities = model(fold.split()[0]), np.array(asked, dtype=float)
    assert frozenset((one, other)) in arm.never_colliding
    assert _least(arm, velocities, one, other) >= D_MIN
    as_told = dataclasses.replace(arm, stand_ins=(), stand_in_pairs=())
    assert _least(as_told, velocities, one, other) < D_MIN


@pytest.mark.parametrize("name", ["ur3", "ur5", "ur10", "ur3e", "ur5e", "panda"])
def test_where_the_guard_is_content_no_two_links_are_near(name):
    arm, rng = model(name), np.random.default_rng(7)
    body, meshes = body_of(arm, D_MIN), Meshes(arm)
    pairs = meshes.pairs(arm.home, D_MIN)
    assert len(pairs) >= 15
    content = 0
    for _ in range(100):
        q = rng.uniform(arm.lower, arm.upper)
        if self_gaps(body, q).min() < D_MIN:
            continue
        content += 1
        meshes.place(q)
        for pair in pairs:
            assert meshes.between(pair.one, pair.other, 0.03) >= D_MIN, (pair.one, pair.other, q)
    assert content > 20
