"""A start that the guard could not keep is refused in one line that names part and obstacle."""

import msgspec
import pytest

from farhand.common.errors import ScenarioError
from farhand.common.shapes.box import Box
from farhand.common.shapes.obstacle import Obstacle
from farhand.common.shapes.plane import Plane
from farhand.common.shapes.sphere import Sphere
from farhand.robot_side.robots.registry import check_scenario
from farhand.robot_side.safety.guard.settings import GuardSettings
from farhand.runs.scenario import load_scenario


def _with(name, *obstacles):
    return msgspec.structs.replace(load_scenario(name), obstacles=obstacles)


def test_a_sphere_that_is_too_near():
    scenario = load_scenario("point-obstacle")
    x, y, z = scenario.start
    above = z + scenario.robot.radius + 0.1 + 0.004
    near = _with("point-obstacle", Obstacle(id="post", position=(x, y, above), shape=Sphere(0.1)))
    said = r"start: the tool stands 4 mm from obstacle 'post'; the guard keeps 10 mm"
    with pytest.raises(ScenarioError, match=said):
        check_scenario(near)
    check_scenario(msgspec.structs.replace(near, guard=GuardSettings(on=False)))


@pytest.mark.parametrize(
    ("obstacle", "part"),
    [
        (Obstacle(id="post", position=(0.205, -0.19, 0.56), shape=Sphere(0.05)), "forearm_link"),
        (Obstacle(id="crate", position=(0.385, -0.28, 0.464), shape=Box((0.02, 0.02, 0.02))), "wrist_1_link"),
    ],
)
def test_a_link_that_is_too_near(obstacle, part):
    with pytest.raises(ScenarioError, match=f"start: {part} of the UR5 stands") as refused:
        check_scenario(_with("ur5-obstacle", obstacle))
    assert repr(obstacle.id) in str(refused.value)
    assert "\n" not in str(refused.value)


def test_an_arm_may_stand_on_its_table():
    check_scenario(_with("ur5-obstacle", Obstacle(id="table", position=(0.0, 0.0, 0.0), shape=Plane())))
