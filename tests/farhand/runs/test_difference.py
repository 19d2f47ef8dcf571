"""What an operator is told whose scenario is not the robot's."""

import msgspec

from farhand.common.shapes.sphere import Sphere
from farhand.runs.difference import difference, scene_difference
from farhand.runs.scenario import load_scenario, replace_settings
from farhand.testing import description, scene


def test_every_difference_is_named_with_both_values():
    scenario = replace_settings(load_scenario("point-obstacle"), {"robot.radius": 0.1})
    assert difference(description(), scenario) == ""
    other = replace_settings(scenario, {"robot.kind": "box", "robot.lag": 0.3, "safety.max_speed": 1.5})
    line = difference(description(), other)
    assert line == (
        "robot 'r' is another one than this scenario says; in force is: robot.kind point (here box), "
        "robot.lag 0.1 s (here 0.3), safety.max_speed 2 m/s (here 1.5)"
    )
    for name in ("radius", "rate_hz", "state_rate_hz", "max_speed", "max_age", "command_timeout"):
        changed = difference(description(**{name: 7.5}), scenario)
        assert f".{name} 7.5 " in changed
        assert "\n" not in changed


def test_a_real_arm_in_place_of_the_scenarios_own_is_no_other_robot():
    scenario = load_scenario("ur5-obstacle")
    here = {"rate_hz": scenario.robot.rate_hz, "lag": scenario.robot.lag, "radius": scenario.robot.radius}
    assert "robot.kind" not in difference(description(kind="ur", model="ur5", **here), scenario)
    assert "robot.kind ur (here ur5)" in difference(description(kind="ur", model="ur10", **here), scenario)


def test_another_scene_is_named_and_where_a_moving_obstacle_is_by_now_is_no_difference():
    scenario = load_scenario("point-obstacle")
    (ball,) = scenario.obstacles[:1]
    same = scene(0, *scenario.obstacles, targets=scenario.targets)
    assert scene_difference(same, scenario) == ""
    larger = msgspec.structs.replace(ball, shape=Sphere(ball.shape.radius + 0.01))
    line = scene_difference(scene(0, larger, *scenario.obstacles[1:], targets=()), scenario)
    assert f"obstacle {ball.id!r} differs" in line
    assert "0 targets there" in line
    assert "\n" not in line
    moving = msgspec.structs.replace(ball, velocity=(0.1, 0.0, 0.0))
    moved = msgspec.structs.replace(moving, position=(9.0, 9.0, 9.0))
    drifting = msgspec.structs.replace(scenario, obstacles=(moving,))
    assert scene_difference(scene(0, moved, targets=scenario.targets), drifting) == ""
