"""Refuses a start of an arm from which the guard could not keep what it promises."""

import numpy as np

from farhand.common.geometry import Array
from farhand.robot_side.arm.model import ArmModel
from farhand.robot_side.kernel.distance import NOTHING
from farhand.robot_side.kernel.room import room
from farhand.robot_side.safety.guard.arm_guard import body_of, self_gaps
from farhand.robot_side.safety.guard.start import Start, refusal
from farhand.robot_side.scene.surroundings import surroundings_of


def check_arm_clear(scenario: Start, arm: ArmModel, q: Array) -> None:
    """Raise ScenarioError where a link's capsule starts in an obstacle or another, or nearer than the guard keeps.

    Args:
        scenario: for the obstacles.
        arm: its model.
        q: (n,) configuration at the start (rad).
    """
    body = body_of(arm, scenario.guard.d_min)
    table = surroundings_of(scenario.obstacles)
    near = np.zeros((len(body.parts) * len(table.ids), 5))
    q = np.ascontiguousarray(q, dtype=float)
    if room(body.chain, body.capsules, q, table.rows, table.vertices, scenario.guard.d_min, -NOTHING, near):
        part, name = body.parts[int(near[0, 0])], table.ids[int(near[0, 1])]
        raise refusal(scenario, f"{part} of the {arm.title}", float(near[0, 4]), f"obstacle {name!r}")
    for k, gap in enumerate(self_gaps(body, q) + body.slack):
        if gap < scenario.guard.d_min:
            one, other = (body.parts[i] for i in body.pairs[k])
            raise refusal(scenario, f"{one} of the {arm.title}", float(gap), f"its own {other}")
