"""Robots by name: a scenario is checked without building its robot, with the words that building it would have."""

import subprocess
import sys

import msgspec
import pytest

from farhand.common.errors import ScenarioError
from farhand.common.messages.scene import Obstacle
from farhand.robot_side.robots import pybullet_arm
from farhand.robot_side.robots.registry import check_scenario, make_robot
from farhand.runs.scenario import load_scenario

UR5 = load_scenario("ur5-obstacle")
UNREACHABLE = msgspec.structs.replace(UR5, start=(3.0, 0.0, 0.5), obstacles=())
INSIDE = msgspec.structs.replace(UR5, obstacles=(Obstacle(id="pole", position=(0.1, 0.0, 0.5), radius=0.1),))


@pytest.mark.parametrize(("scenario", "named"), [(UNREACHABLE, "unreachable"), (INSIDE, "'pole'")])
def test_a_start_that_cannot_be_is_told_as_building_the_robot_tells_it(scenario, named):
    said = []
    for attempt in (check_scenario, make_robot):
        with pytest.raises(ScenarioError) as refused:
            attempt(scenario)
        said.append(str(refused.value))
    assert said[0] == said[1]
    assert named in said[0]
    assert "\n" not in said[0]


def test_the_check_builds_no_robot(monkeypatch):
    monkeypatch.setattr(pybullet_arm.ArmRobot, "__init__", lambda *_: pytest.fail("built"))
    for name in ("ur5-obstacle", "box-obstacle", "point-obstacle"):
        check_scenario(load_scenario(name))


def test_the_check_leaves_no_world_behind():
    import pybullet

    before = sum(map(pybullet.isConnected, range(64)))
    check_scenario(UR5)
    with pytest.raises(ScenarioError):
        check_scenario(INSIDE)
    assert sum(map(pybullet.isConnected, range(64))) == before


def test_what_needs_no_engine_loads_none():
    code = (
        "import sys; from farhand.runs.scenario import load_scenario;"
        "from farhand.robot_side.robots.registry import check_scenario;"
        "[check_scenario(load_scenario(f'{name}-obstacle')) for name in ('point', 'box')];"
        "assert not {'pybullet', 'pinocchio'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
