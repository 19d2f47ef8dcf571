"""Bounds in place of what they bound: a link's motion from its joint's frame, a row's need from the speeds alone."""

import numpy as np
import pytest

from farhand.common.seeds import stream
from farhand.robot_side.arm.model import model
from farhand.robot_side.kernel import body
from farhand.robot_side.kernel.rows import approach, far_off
from farhand.robot_side.safety.guard.arm_guard import ArmGuard, body_of
from farhand.robot_side.safety.guard.settings import GuardSettings


@pytest.mark.parametrize("name", ["ur5", "panda"])
def test_no_point_of_a_link_moves_farther_than_is_said(name):
    arm, rng = model(name), stream(1, "moved")
    chain, n, reach = body_of(arm, 0.0).chain, arm.n, 0.3
    then, now = ((np.zeros((n, 3, 3)), np.zeros((n, 3))) for _ in range(2))
    closest = np.inf
    for scale in (1e-4, 1e-2, 1.0) * 20:
        q = arm.home + rng.normal(0.0, 0.5, n)
        body.frames(chain, q, *then)
        body.frames(chain, q + rng.normal(0.0, scale, n), *now)
        points = rng.normal(0.0, 1.0, (200, 3))
        points *= reach / np.linalg.norm(points, axis=1)[:, None]
        gone = [
            np.linalg.norm(points @ (now[0][i] - then[0][i]).T + now[1][i] - then[1][i], axis=1).max()
            for i in range(n)
        ]
        most, each = np.zeros(n), np.arange(n)
        body.moved_at_most(*now, *then, reach, each, most)
        assert np.all(gone <= most + 1e-12)
        closest = min(closest, float((most / gone).min()))
        body.moved_at_most(*now, *then, reach, each, most)
        assert not most.any()
    assert closest < 1.2  # a bound that says too much is safe, but has everything measured


def test_from_where_a_row_is_left_out_every_row_would_let_the_approach_pass():
    par = ArmGuard(model("ur5"), GuardSettings(), 0.016, 0.002)._par
    rng = stream(2, "far off")
    for _ in range(3000):
        n = int(rng.integers(1, 8))
        acceleration = rng.uniform(1.0, 15.0, n)
        row = rng.uniform(0.0, 1.0, n) * 10.0 ** rng.uniform(-9.0, 0.0)
        speeds = rng.uniform(0.0, 3.0, n) * 10.0 ** rng.uniform(-6.0, 0.0)
        closing, lever = float(row @ speeds), float(row @ acceleration)
        braking = min(par[body.BRAKING], 0.3 * lever)
        x = far_off(closing, speeds.max(), acceleration.min(), par)
        assert approach(x, braking, par) >= closing
