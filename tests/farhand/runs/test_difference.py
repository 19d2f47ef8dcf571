"""What an operator is told whose scenario is not the robot's."""

from farhand.runs.difference import difference
from farhand.runs.scenario import load_scenario, replace_settings
from farhand.testing import description


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
