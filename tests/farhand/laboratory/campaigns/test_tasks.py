import itertools

import pytest

from farhand.common.geometry import distance
from farhand.laboratory.campaigns.tasks import (
    BOX_RADIUS,
    HIGH,
    LEG,
    LOW,
    OBSTACLE_GAP,
    OBSTACLES,
    RADII,
    TARGET_GAP,
    TARGETS,
    make_task,
)
from farhand.operator_side.margins.adaptive import AdaptiveSettings

TASKS = [make_task(3, index) for index in range(60)]


@pytest.mark.parametrize("task", TASKS[:20], ids=lambda task: task.name)
def test_a_task_keeps_all_distances(task):
    points = [task.start, *task.targets]
    for a, b in itertools.combinations(task.obstacles, 2):
        assert distance(a.position, b.position) - a.shape.radius - b.shape.radius >= OBSTACLE_GAP
    for a, b in itertools.combinations(points, 2):
        assert distance(a, b) >= LEG
    for point, obstacle in itertools.product(points, task.obstacles):
        assert distance(point, obstacle.position) - obstacle.shape.radius >= TARGET_GAP
        # so that no margin up to its cap makes a target unreachable
        assert BOX_RADIUS + task.controller.d_min + AdaptiveSettings().cap <= TARGET_GAP
    for x, y, z in [*points, *(o.position for o in task.obstacles)]:
        assert y == 0.0
        assert LOW <= x <= HIGH
        assert LOW <= z <= HIGH


def test_numbers_and_radii_use_their_whole_ranges():
    assert {len(task.obstacles) for task in TASKS} == set(range(OBSTACLES[0], OBSTACLES[1] + 1))
    assert {len(task.targets) for task in TASKS} == set(range(TARGETS[0], TARGETS[1] + 1))
    radii = [o.shape.radius for task in TASKS for o in task.obstacles]
    assert RADII[0] <= min(radii) < RADII[0] + 0.02
    assert RADII[1] - 0.04 < max(radii) <= RADII[1]


def test_a_task_depends_on_seed_and_index_alone():
    assert make_task(3, 7) == TASKS[7]
    assert make_task(3, 7, "box", "paper").obstacles == TASKS[7].obstacles
    assert make_task(4, 7).obstacles != TASKS[7].obstacles
    assert make_task(3, 8).start != TASKS[7].start


def test_the_box_is_that_of_the_paper():
    assert pytest.approx(0.18371, abs=1e-5) == BOX_RADIUS
    task = TASKS[0]
    assert task.controller.speed_limit == (0.5, 0.5, 0.5)
    assert (task.controller.d_min, task.controller.gamma) == (0.01, 0.5)
    assert task.margin.own == {"paper": {"max_speed": 0.87}, "adaptive": {"least": 0.01}}
