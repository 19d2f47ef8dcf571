"""Lists of what there is: whole in 80 columns, no name cut off."""

import pytest

from farhand.commands.arm_tables import print_arms
from farhand.commands.runs import networks, scenarios
from farhand.robot_side.arm.model import model


@pytest.mark.parametrize(
    ("listed", "names"),
    [
        (networks, ["recorded:runs/20260131-235959-ur5-obstacle", "bursty-loss-20"]),
        (scenarios, ["panda-obstacle"]),
        (lambda: print_arms([model("panda")]), ["panda_hand_tcp"]),
    ],
)
def test_no_name_is_cut_off_in_80_columns(listed, names, monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", "80")
    listed()
    said = capsys.readouterr().out
    assert "…" not in said
    assert set(names) <= set(said.split())
    assert max(map(len, said.splitlines())) <= 80
