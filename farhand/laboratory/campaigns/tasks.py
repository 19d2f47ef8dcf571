"""Random tasks in the manner of the paper: a box among spheres in the xz-plane (arXiv 2403.18650, section V).

The paper gives the domain [0.45, 7.6]^2 m and "resampled when too close"; the numbers of obstacles and
targets and the distances are the readings below. A task depends on its seed and its index alone.
"""

import math
from typing import Literal

import numpy as np

from farhand.common.geometry import distance
from farhand.common.messages.base import Vector3
from farhand.common.messages.scene import Obstacle
from farhand.common.seeds import stream
from farhand.common.shapes.distance import distance_to
from farhand.operator_side.control.settings import ControllerSettings
from farhand.operator_side.margins.adaptive import AdaptiveSettings
from farhand.operator_side.margins.settings import MarginSettings
from farhand.robot_side.robots.settings import RobotSettings
from farhand.robot_side.safety.guard.settings import GuardSettings
from farhand.runs.scenario import Scenario

LOW, HIGH = 0.45, 7.6
OBSTACLES = (6, 12)
TARGETS = (3, 6)
RADII = (0.2, 0.6)
OBSTACLE_GAP = 0.8
"""Between the surfaces of two obstacles (m)."""
TARGET_GAP = 0.6
"""From the box's centre, at the start or at a target, to an obstacle's surface (m): the box's radius, d_min
and the largest adaptive margin fit between, so that no margin law makes a target unreachable."""
LEG = 1.0
"""Between the start or a target and any other (m)."""
BOX_SIZE = (0.25, 0.25, 0.1)
BOX_RADIUS = math.hypot(*BOX_SIZE) / 2
LAG = 0.1
PAPERS_EFFORT, OWN_EFFORT = 1.0, ControllerSettings().r
"""Weights R of effort: the paper's, and what Farhand takes where nothing is said."""
TRIES = 2000

BoxKind = Literal["point", "box"]
"""`point`: kinematic, first-order lag; `box`: rigid body in PyBullet."""


def make_task(
    seed: int,
    index: int,
    robot: BoxKind = "point",
    margin: str = "adaptive",
    *,
    effort: float = PAPERS_EFFORT,
) -> Scenario:
    """Task `index` of a campaign, with the paper's settings.

    Args:
        seed: of the campaign.
        index: of the task.
        robot: which model of the box.
        margin: margin law; it has no influence on the task itself.
        effort: weight R.
    """
    draw = stream(seed, "task", str(index))
    while True:
        obstacles = _obstacles(draw, int(draw.integers(OBSTACLES[0], OBSTACLES[1] + 1)))
        if obstacles is None:
            continue
        points = _points(draw, 1 + int(draw.integers(TARGETS[0], TARGETS[1] + 1)), obstacles)
        if points is not None:
            break
    return Scenario(
        name=f"task-{seed}-{index}",
        description="random obstacles and targets in the xz-plane",
        start=points[0],
        targets=tuple(points[1:]),
        obstacles=tuple(obstacles),
        robot=box_settings(robot),
        guard=GuardSettings(on=False),  # what is measured is the operator's side, as the paper has it
        controller=ControllerSettings(r=effort, speed_limit=(0.5, 0.5, 0.5)),
        margin=MarginSettings(kind=margin, own=_margins_own(papers=effort == PAPERS_EFFORT)),
    )


def _margins_own(*, papers: bool) -> dict[str, dict[str, float]]:
    """Settings of the margins; in the paper's experiment the floor is the same at any speed."""
    own = {"paper": {"max_speed": 0.87}}
    return own | {"adaptive": {"least": AdaptiveSettings().floor}} if papers else own


def box_settings(robot: BoxKind) -> RobotSettings:
    """The free-flying box; both models run at 500 Hz, so that a command waits for at most 2 ms."""
    return RobotSettings(kind=robot, radius=BOX_RADIUS, rate_hz=500.0, state_rate_hz=50.0, lag=LAG)


def _obstacles(draw: np.random.Generator, count: int) -> list[Obstacle] | None:
    """Spheres that leave passages between them; None when they do not fit."""
    found: list[Obstacle] = []
    for _ in range(TRIES):
        radius = float(draw.uniform(*RADII))
        centre = _point(draw)
        if all(distance_to(o, centre) >= radius + OBSTACLE_GAP for o in found):
            found.append(Obstacle(id=f"o{len(found)}", position=centre, radius=radius))
            if len(found) == count:
                return found
    return None


def _points(draw: np.random.Generator, count: int, obstacles: list[Obstacle]) -> list[Vector3] | None:
    """Start and targets, clear of the obstacles and of each other; None when they do not fit."""
    found: list[Vector3] = []
    for _ in range(TRIES):
        point = _point(draw)
        clear = all(distance_to(o, point) >= TARGET_GAP for o in obstacles)
        if clear and all(distance(point, other) >= LEG for other in found):
            found.append(point)
            if len(found) == count:
                return found
    return None


def _point(draw: np.random.Generator) -> Vector3:
    x, z = draw.uniform(LOW, HIGH, size=2)
    return (float(x), 0.0, float(z))
