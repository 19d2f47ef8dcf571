"""Refuses a start of an arm from which the guard could not keep what it promises."""

import numpy as np

from farhand.common.geometry import Array
from farhand.robot_side.arm.model import ArmModel
from farhand.robot_side.kernel.distance import capsule_row
from farhand.robot_side.kernel.rows import SHORT_LEVER
from farhand.robot_side.safety.guard.arm_guard import body_of, placed, self_gaps
from farhand.robot_side.safety.guard.start import Start, refusal
from farhand.robot_side.scene.surroundings import Surroundings, surroundings_of


def check_arm_clear(scenario: Start, arm: ArmModel, q: Array) -> None:
    """Raise ScenarioError where a link's capsule starts in an obstacle or another, or nearer than the guard keeps.

    Args:
        scenario: for the obstacles.
        arm: its model.
        q: (n,) configuration at the start (rad).
    """
    body = body_of(arm, scenario.guard.d_min)
    table = surroundings_of(scenario.obstacles)
    A, B = placed(body, q)
    origins, axes = _axes(arm, q)
    for i, part in enumerate(body.parts):
        joint = int(body.capsules[i, 0])
        for j, name in enumerate(table.ids):
            gap = _gap(A[i], B[i], body.capsules[i, 7], table, j, origins[: joint + 1], axes[: joint + 1])
            if gap < scenario.guard.d_min:
                raise refusal(scenario, f"{part} of the {arm.title}", gap, f"obstacle {name!r}")
    for k, gap in enumerate(self_gaps(body, q) + body.slack):
        if gap < scenario.guard.d_min:
            one, other = (body.parts[i] for i in body.pairs[k])
            raise refusal(scenario, f"{one} of the {arm.title}", float(gap), f"its own {other}")


def _gap(
    a: Array, b: Array, radius: float, table: Surroundings, j: int, origins: Array, axes: Array
) -> float:
    """Distance of what the joints can move of a capsule to obstacle j (m): its foot may stand where it was put."""
    for _ in range(2):
        gap, t, *n = capsule_row(a, b, radius, table.rows[j], table.vertices)
        witness = a + t * (b - a)
        lever = float(np.abs(np.cross(axes, witness - origins) @ np.array(n)).sum()) if len(axes) else 0.0
        if lever >= SHORT_LEVER:
            return float(gap)
        middle = 0.5 * (a + b)
        a, b = (middle, b) if t < 0.5 else (a, middle)
    return float(gap) if lever >= SHORT_LEVER else 1e6


def _axes(arm: ArmModel, q: Array) -> tuple[Array, Array]:
    rotations, origins = arm.poses(q)
    return origins, np.einsum("nij,nj->ni", rotations, arm.axes)
