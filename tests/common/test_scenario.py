"""Scenarios: what is built in loads, what is wrong is named with its key."""

import math

import pytest
import tomli_w
from hypothesis import example, given
from hypothesis import strategies as st

from farhand.common.errors import ScenarioError
from farhand.common.messages.scene import Obstacle
from farhand.runs.scenario import (
    built_in_names,
    load_scenario,
    parse_scenario,
    replace_setting,
    replace_settings,
    scenario_from_table,
    scenario_to_table,
)

GOOD = """
name = "x"
start = [0.0, 0.0, 0.0]
targets = [[1.0, 0.0, 0.0]]
[[obstacles]]
id = "ball"
position = [0.5, 0.0, 0.0]
radius = 0.1
"""


@pytest.mark.parametrize("name", built_in_names())
def test_built_in_scenarios_load_and_survive_toml(name):
    scenario = load_scenario(name)
    assert scenario.name == name
    assert scenario.description
    table = scenario_to_table(scenario)
    assert parse_scenario(tomli_w.dumps(table), "again") == scenario


def test_a_file_loads_and_defaults_are_the_papers_but_for_effort(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(GOOD)
    scenario = load_scenario(str(path))
    assert scenario.obstacles == (Obstacle("ball", (0.5, 0.0, 0.0), 0.1),)
    c = scenario.controller
    assert (c.horizon, c.period, c.q, c.r, c.p, c.s, c.p_omega) == (10, 0.1, 10, 0.1, 10, 10, 100)
    assert scenario.predictor == "timeline"
    assert replace_setting(scenario, "margin.kind", "paper").predictor == "history"
    assert replace_setting(scenario, "operator.predictor", "echo").predictor == "echo"


@pytest.mark.parametrize(
    ("old", "new", "key"),
    [
        ("radius = 0.1", "radius = -0.1", "obstacles[0].radius"),
        ("radius = 0.1", "radius = 0", "obstacles[0].radius"),
        ("radius = 0.1", "radius = nan", "obstacles[0].radius: must be a finite number"),
        ("radius = 0.1", 'radius = "big"', "obstacles[0].radius"),
        ("radius = 0.1", "", "missing required field `shape`, or the `radius` of a sphere"),
        ("radius = 0.1", "radius = 0.1\ncolour = 1", "unknown field `colour`"),
        ("radius = 0.1", "radius = 0.49", "start: lies 0.010 m from obstacle 'ball'"),
        ("radius = 0.1", "radius = 0.6", "start"),
        ('id = "ball"', 'id = ""', "obstacles[0].id"),
        ("start = [0.0, 0.0, 0.0]", "start = [0.0, inf, 0.0]", "start[1]: must be a finite number"),
        ("start = [0.0, 0.0, 0.0]", "start = [0.0, 0.0]", "start"),
        ("start = [0.0, 0.0, 0.0]", "start = [0.0, 0.0, 1e9]", "start[2]"),
        ("start = [0.0, 0.0, 0.0]", "", "missing required field `start`"),
        ("targets = [[1.0, 0.0, 0.0]]", "targets = []", "targets"),
        ("targets = [[1.0, 0.0, 0.0]]", "targets = [[1.0, 0.0, -inf]]", "targets[0][2]: must be"),
        ('name = "x"', 'name = ""', "name"),
        ('name = "x"', 'name = "x"\ncolour = "red"', "unknown field `colour`"),
        ('name = "x"', 'name = "x', "not valid TOML"),
        ('name = "x"', 'name = 1979-05-27', "name"),
    ],
)  # fmt: skip
def test_errors_name_the_key_and_are_one_line(old, new, key):
    with pytest.raises(ScenarioError) as found:
        parse_scenario(GOOD.replace(old, new), "mine.toml")
    assert key in str(found.value)
    assert "scenario mine.toml: " in str(found.value)
    assert "\n" not in str(found.value)


@pytest.mark.parametrize(
    ("key", "value", "named"),
    [
        ("robot.radius", -0.05, "robot.radius"),
        ("robot.kind", "kuka", "robot.kind"),
        ("robot.rate_hz", 0, "robot.rate_hz"),
        ("robot.joints", [0.0] * 5, "robot.joints"),
        ("robot.colour", 1, "unknown field `colour`"),
        ("safety.max_age", 0.0, "safety.max_age"),
        ("safety.max_age", math.nan, "safety.max_age: must be a finite number"),
        ("safety.stop_timeout", 0.1, "safety.stop_timeout"),
        ("safety.lease_timeout", 1.4, "safety.lease_timeout: 1.4 s is shorter than safety.stop_timeout"),
        ("safety.evade_timeout", 61.0, "safety.evade_timeout"),
        ("controller.gamma", 0.0, "controller.gamma"),
        ("controller.gamma", 1.5, "controller.gamma"),
        ("controller.horizon", 0, "controller.horizon"),
        ("controller.horizon", 2.5, "controller.horizon"),
        ("controller.d_min", -1.0, "controller.d_min"),
        ("controller.d_min", 0.6, "controller.d_min"),
        (
            "controller.speed_limit",
            [0.3, 2.5, 0.3],
            "controller.speed_limit: 2.5 m/s is above safety.max_speed",
        ),
        ("targets", [[1.0, 0.0, 0.0], [0.5, 0.05, 0.0]], "targets[1]: lies 0.050 m inside obstacle 'ball'"),
        ("targets", [[0.62, 0.0, 0.0]], "targets[0]: lies 0.020 m from obstacle 'ball'"),
        ("controller.solver", "magic", "controller.solver"),
        ("controller.speed_limit", [0.3, 0.3], "controller.speed_limit"),
        ("controller.p_omega", 10**400, "controller.p_omega"),
        ("margin.kind", "wide", "margin.kind"),
        ("margin.rtt_span", 0, "margin.rtt_span"),
        ("steering.tester.far", 0.1, "steering.tester.far: far, 0.1 m, must be larger than near"),
        ("steering.tester.speed", 0.1, "setting steering.tester.speed: unknown field `speed`"),
        ("steering.mouse.far", 0.1, "steering.mouse"),
        ("margin.floor", 0.1, "are in its table: margin.adaptive.floor"),
        ("margin.paper.k_sigma", -1.0, "setting margin.paper.k_sigma: expected a number >= 0"),
        ("margin.own", 3, "margin.own"),
        ("margin.own.paper", 3, "margin"),
        ("robot.kind", "ur7", "robot.kind 'ur7': no such robot"),
        ("operator.predictor", "oracle", "operator.predictor"),
        ("gamma", 0.3, "unknown field `gamma`"),
        ("name.first", 1, "no such key"),
        ("obstacles.radius", 1, "no such key"),
        ("nothing.at.all", 1, "unknown field `nothing`"),
    ],
)
def test_bad_settings_name_the_key(key, value, named):
    with pytest.raises(ScenarioError) as found:
        replace_setting(parse_scenario(GOOD, "x"), key, value)
    assert named in str(found.value)
    assert "\n" not in str(found.value)


def test_replacing_a_setting_leaves_the_rest():
    before = parse_scenario(GOOD, "x")
    after = replace_setting(before, "controller.gamma", 0.3)
    assert after.controller.gamma == 0.3
    assert before.controller.gamma == 0.5
    assert replace_setting(after, "controller.gamma", 0.5) == before


def test_an_obstacle_may_not_be_there_twice():
    table = scenario_to_table(parse_scenario(GOOD, "x"))
    table["obstacles"] = table["obstacles"] * 2
    with pytest.raises(ScenarioError, match=r"obstacles\[1\]\.id: 'ball' is there twice"):
        scenario_from_table(table, "x")


@pytest.mark.parametrize("name", ["nope", "", "x" * 300, "a\0b", "nope.toml", "/", "../scenarios", "."])
def test_unknown_names_and_files_are_one_line(name):
    with pytest.raises(ScenarioError) as found:
        load_scenario(name)
    assert "\n" not in str(found.value)


def test_files_that_are_no_text_or_too_deep(tmp_path):
    path = tmp_path / "x.toml"
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ScenarioError, match="cannot be read"):
        load_scenario(str(path))
    path.write_text("a = " + "[" * 100_000)
    with pytest.raises(ScenarioError, match="not valid TOML"):
        load_scenario(str(path))


@given(st.text(max_size=200))
def test_any_text_is_a_scenario_error(text):
    with pytest.raises(ScenarioError):
        parse_scenario(text, "x")


values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=6,
)
SECTIONS = ["name", "start", "targets", "obstacles", "robot", "safety", "controller", "margin", "network"]


@given(st.sampled_from(SECTIONS), values)
@example("robot", {"\n": {}})
def test_any_value_for_a_key_is_taken_or_a_scenario_error(key, value):
    table = scenario_to_table(parse_scenario(GOOD, "x")) | {key: value}
    try:
        found, line = scenario_from_table(table, "x"), "scenario x: "
    except ScenarioError as error:
        found, line = None, str(error)
    assert line.startswith("scenario x: ")
    assert "\n" not in line
    assert found is None or scenario_from_table(scenario_to_table(found), "x") == found


def test_settings_are_judged_together_whatever_their_order():
    base = parse_scenario(GOOD, "x")
    pairs = [
        {"controller.speed_limit": [3.0] * 3, "safety.max_speed": 3.0},
        {"safety.stop_timeout": 0.2, "safety.command_timeout": 0.1},
        {"targets": [[0.5, 0.0, 0.0]], "obstacles": []},
    ]
    for settings in pairs:
        found = replace_settings(base, settings)
        assert found == replace_settings(base, dict(reversed(settings.items())))


def test_an_obstacle_that_moves_may_be_where_a_target_is():
    table = scenario_to_table(parse_scenario(GOOD, "x")) | {"targets": [[0.5, 0.0, 0.0]]}
    table["obstacles"][0]["velocity"] = [0.1, 0.0, 0.0]
    assert scenario_from_table(table, "x").targets == ((0.5, 0.0, 0.0),)


@pytest.mark.parametrize(
    ("key", "said"),
    [
        (
            "controller.gama",
            "setting controller.gama: unknown field `gama`; is gamma meant? there are angular_limit, d_min, ",
        ),
        ("controler.gamma", "unknown field `controler`; is controller meant? there are camera, "),
        ("gamma", "unknown field `gamma`; is controller.gamma meant? there are "),
        ("safety.lease_time", "unknown field `lease_time`; is lease_timeout meant? there are "),
        (
            "steering.tester.far_sped",
            "setting steering.tester.far_sped: unknown field `far_sped`; is far_speed meant? there are ",
        ),
        ("name.first", "'name' is no section; there are "),
        ("network.up", "unknown field `up`; there are downlink, uplink"),
    ],
)
def test_an_unknown_key_is_answered_by_those_there_are_the_nearest_first(key, said):
    with pytest.raises(ScenarioError) as found:
        replace_setting(parse_scenario(GOOD, "x"), key, 1)
    assert said in str(found.value)
    assert "own" not in str(found.value).split("there are")[1].replace(",", "").split()


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("robot.lag", "300ms", "scenario setting robot.lag: expected a number (s), got text"),
        ("robot.radius", -1, "scenario setting robot.radius: expected a number (m) >= 0.0"),
        ("robot.rate_hz", "fast", "scenario setting robot.rate_hz: expected a number (Hz), got text"),
        (
            "margin.adaptive.floor",
            "x",
            "scenario setting margin.adaptive.floor: expected a number (m), got text",
        ),
        ("controller.horizon", "x", "scenario setting controller.horizon: expected a whole number, got text"),
    ],
)
def test_a_useless_value_is_told_once_with_the_unit_of_what_would_do(key, value, said):
    with pytest.raises(ScenarioError) as found:
        replace_setting(load_scenario("point-obstacle"), key, value)
    assert str(found.value) == said


def test_an_unknown_key_of_an_obstacle_too():
    with pytest.raises(ScenarioError, match=r"obstacles\[0\]: .*`radus`; is radius meant\? there are "):
        parse_scenario(GOOD.replace("radius = 0.1", "radius = 0.1\nradus = 1"), "x")
