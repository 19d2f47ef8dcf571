"""docs/scenes.md: what it shows is read as it stands, and the numbers of spheres are those it says."""

import re
from pathlib import Path

from farhand.common.messages.scene import Obstacle
from farhand.common.shapes.box import Box
from farhand.common.shapes.capsule import Capsule
from farhand.common.shapes.cover import cover
from farhand.runs.scenario import parse_scenario

TEXT = (Path(__file__).resolve().parents[2] / "docs" / "scenes.md").read_text(encoding="utf-8")
HEAD = 'name = "x"\nstart = [0.0, -0.5, 0.6]\ntargets = [[0.0, -0.4, 0.6]]\n'


def spheres(shape):
    return len(cover(Obstacle("it", (0.0, 0.0, 0.0), shape=shape))[1])


def test_every_table_of_the_page_is_read_as_it_stands():
    blocks = re.findall(r"```toml\n(.*?)```", TEXT, re.DOTALL)
    named = [o.id for block in blocks for o in parse_scenario(HEAD + block, "page").obstacles]
    assert named == ["ball", "crate", "table", "wall", "cart"]


def test_it_takes_as_many_spheres_as_the_page_says():
    rows = re.findall(r"\| (capsule of|cube of|box of|beam of|table top of) .*\| ([\d; ]+)", TEXT)
    said = {kind.split()[0]: [int(number) for number in numbers.split(";")] for kind, numbers in rows}
    assert said == {
        "capsule": [spheres(Capsule(0.03, 0.2)), spheres(Capsule(0.05, 0.5))],
        "cube": [spheres(Box((half,) * 3)) for half in (0.02, 0.05, 0.1, 0.2)],
        "box": [spheres(Box((0.15, 0.1, 0.05)))],
        "beam": [spheres(Box((0.03, 0.03, 0.5)))],
        "table": [spheres(Box((0.6, 0.4, 0.02)))],
    }
