"""The table's figures: any margin law has a style of its own."""

from farhand.cli import run
from farhand.laboratory.campaigns.figures import OTHERS, STYLES, draw_table1, style_of
from farhand.laboratory.campaigns.jobs import Row
from farhand.laboratory.campaigns.table1 import Table1


def test_laws_from_outside_take_turns_and_differ():
    margins = ["none", "mine", "adaptive", *(f"other{n}" for n in range(len(OTHERS) - 1))]
    styles = [style_of(margin, margins) for margin in margins]
    assert styles[0] == STYLES["none"]
    assert len({style.colour for style in styles}) == len({style.name for style in styles}) == len(margins)
    assert style_of("fifth", ["a", "b", "c", "d", "fifth"]).colour == OTHERS[0][0]


def test_a_table_with_a_fourth_law_is_drawn(tmp_path, monkeypatch):
    table = Table1(tasks=1, delays=("constant",), margins=("none", "mine"), time_limit=1.0)
    known = Table1.job
    monkeypatch.setattr(
        Table1,
        "job",
        lambda self, delay, margin, index: known(self, delay, "paper" if margin == "mine" else margin, index),
    )
    rows = [
        Row(
            key=f"constant/{margin}/0",
            labels={"delay": "constant", "margin": margin, "task": 0, "robot": "point"},
            seed=1,
            min_clearance=0.02,
            duration=1.0,
        )
        for margin in table.margins
    ]
    assert [path.name for path in draw_table1(table, rows, tmp_path)] == [
        "path.png",
        "clearance.png",
        "boxes.png",
    ]


def test_the_tables_margins_are_those_of_the_registry(capsys):
    assert run(["table1", "--margins", "none,lunar"]) == 2
    assert "'lunar': must be some of none, paper, watchful, adaptive" in capsys.readouterr().err
