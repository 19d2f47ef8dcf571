"""Obstacles in a scenario's file: meshes beside it, planes by their normal, and what the controller could not see."""

import math

import pytest

from farhand.common.errors import ScenarioError
from farhand.common.shapes.cover import plane_of
from farhand.runs.scenario import load_scenario, parse_scenario, scenario_from_table, scenario_to_table

HEAD = """
name = "x"
start = [0.0, 0.0, 0.5]
targets = [[1.0, 0.0, 0.5]]
[robot]
kind = "point"
[[obstacles]]
id = "it"
"""
SHUTTLE = "radius = 0.1\npath = [[0.5, -1.0, 0.5], [0.5, 1.0, 0.5]]\nspeed = 0.3\nacceleration = 0.5"
BOX = """
position = [0.5, 0.5, 0.0]
orientation = [0.5, 0.5, 0.5, 0.5]
shape = { kind = "box", half_extents = [0.1, 0.2, 0.3] }
"""
MESH = """
position = [0.5, 0.5, 0.0]
shape = { kind = "mesh", vertices = [[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]] }
"""
TETRAHEDRON = "v 0 0 0\nv 100 0 0\nv 0 100 0\nv 0 0 100\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n"


def read(text):
    return parse_scenario(HEAD + text, "mine.toml")


@pytest.mark.parametrize(
    "text",
    [
        "position = [0.5, 0.5, 0.0]\nradius = 0.1",
        'position = [0.5, 0.5, 0.0]\nshape = { kind = "capsule", radius = 0.03, half_length = 0.2 }',
        BOX,
        'position = [0.0, 0.0, 0.0]\nshape = { kind = "plane" }',
        'position = [0.0, 2.0, 0.0]\nnormal = [0.0, -1.0, 0.0]\nshape = { kind = "plane" }',
        MESH,
        SHUTTLE,
    ],
)
def test_every_form_survives_the_table(text):
    scenario = read(text)
    assert scenario_from_table(scenario_to_table(scenario), "again") == scenario


def test_a_mesh_lies_beside_the_scenario_wherever_that_is_read_from(tmp_path, monkeypatch):
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "part.obj").write_text(TETRAHEDRON)
    text = 'position = [0.5, 0.5, 0.0]\nshape = { kind = "mesh", file = "parts/part.obj", scale = 0.001 }'
    (tmp_path / "mine.toml").write_text(HEAD + text)
    monkeypatch.chdir("/")
    (found,) = load_scenario(str(tmp_path / "mine.toml")).obstacles
    assert sorted(found.shape.vertices) == [(0, 0, 0), (0, 0, 0.1), (0, 0.1, 0), (0.1, 0, 0)]


@pytest.mark.parametrize("normal", [(0, 0, 1), (0, 0, -1), (0, -3, 0), (1, 2, -0.5), (1e-9, 0, -1)])
def test_a_normal_points_where_it_says(normal):
    away = [-9.0 * n for n in normal]
    scenario = read(f'position = {away}\nnormal = {list(normal)}\nshape = {{ kind = "plane" }}')
    found, _ = plane_of(scenario.obstacles[0])
    assert found * math.hypot(*normal) == pytest.approx(normal, abs=1e-8)


def test_a_shuttle_begins_at_its_first_way_point():
    (shuttle,) = read(SHUTTLE).obstacles
    assert (shuttle.position, shuttle.velocity, shuttle.moves) == ((0.5, -1.0, 0.5), (0.0, 0.0, 0.0), True)


AT = "position = [0.5, 0.5, -9.0]\n"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('shape = { kind = "mesh", file = "part.stl" }', "obstacles[0].shape.file: part.stl cannot be read"),
        ('shape = { kind = "mesh", file = 3 }', "obstacles[0].shape.file: expected the name"),
        ('shape = { kind = "mesh", file = "a.stl", size = 2 }', "a mesh from a file has no key `size`"),
        ('shape = { kind = "mesh", file = "a.stl", scale = 0 }', "obstacles[0].shape.scale: expected a number above 0"),
        ('shape = { kind = "mesh" }', "obstacles[0].shape: object missing required field `vertices`"),
        ('shape = { kind = "sphere", radius = 0 }', "obstacles[0].shape.radius: expected a number (m) > 0.0"),
        ('shape = { kind = "box", half_extents = [1, 0, 1] }', "obstacles[0].shape.half_extents[1]"),
        ('shape = { kind = "cone" }', "obstacles[0].shape.kind"),
        ('shape = { kind = "plane" }\nnormal = [0, 0, 0]', "obstacles[0].normal: has no direction"),
        ('shape = { kind = "plane" }\nnormal = "up"', "obstacles[0].normal: expected three numbers"),
        ('shape = { kind = "plane" }\nnormal = [0, 0, 1]\norientation = [1, 0, 0, 0]', "obstacles[0].normal"),
        ('radius = 0.1\nnormal = [0, 0, 1]', "unknown field `normal`"),
        ('radius = 0.1\npath = [[0, 0, 0]]', "obstacles[0]: path: a shuttle needs at least two way-points"),
        ('shape = { kind = "box", half_extents = [5, 5, 1] }', "obstacles[0].shape: takes more than 2000 spheres"),
    ],
)  # fmt: skip
def test_what_will_not_do_is_one_line_with_its_key(text, said):
    with pytest.raises(ScenarioError) as found:
        read(AT + text)
    assert str(found.value).startswith("scenario mine.toml: obstacles[0]")
    assert said in str(found.value)
    assert "\n" not in str(found.value)


@pytest.mark.parametrize(
    ("shape", "said"),
    [
        ('{ kind = "box", half_extents = [0.3, 0.1, 0.1] }', "start: lies 0.050 m from obstacle 'it'"),
        ('{ kind = "capsule", radius = 0.05, half_length = 0.3 }', "start"),
    ],
)
def test_the_start_is_judged_against_the_exact_shape(shape, said):
    at = "[0.35, 0.0, 0.5]" if "box" in shape else "[0.08, 0.0, 0.3]"
    with pytest.raises(ScenarioError, match=said):
        read(f"position = {at}\nshape = {shape}")


def test_a_box_beside_a_target_may_be_nearer_than_its_ball_would_let_it():
    long = 'position = [1.0, 0.2, 0.5]\nshape = { kind = "box", half_extents = [0.4, 0.1, 0.05] }'
    assert read(long)
    with pytest.raises(ScenarioError, match=r"targets\[0\]: lies 0.050 m from"):
        read(long.replace("0.2,", "0.15,"))


def test_all_together_may_not_be_too_many(tmp_path):
    table = scenario_to_table(read("position = [0.0, 0.0, -5.0]\nradius = 0.1"))
    hall = {"kind": "box", "half_extents": [0.5, 0.5, 0.5]}
    table["obstacles"] = [
        {"id": f"o{k}", "position": [0.0, 0.0, -5.0 * k - 5.0], "shape": hall} for k in range(9)
    ]
    with pytest.raises(ScenarioError, match="all shapes together take more than 8000 spheres"):
        scenario_from_table(table, "x")
    mesh = {
        "kind": "mesh",
        "vertices": [[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]] * 60,
    }
    table["obstacles"] = [{"id": f"o{k}", "position": [0.0, 0.0, -5.0], "shape": mesh} for k in range(200)]
    with pytest.raises(ScenarioError, match="bytes on the wire"):
        scenario_from_table(table, "x")
