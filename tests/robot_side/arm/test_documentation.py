"""docs/arms.md says what the arms are."""

from pathlib import Path

import numpy as np
import pytest

from farhand.robot_side.arm.catalogue import ARMS
from farhand.robot_side.arm.model import model

PAGE = (Path(__file__).resolve().parents[3] / "docs" / "arms.md").read_text()
ROWS = [
    [cell.strip() for cell in line.strip("|").split("|")]
    for line in PAGE.splitlines()
    if line.startswith("|")
]


def test_the_capsules_are_those_that_are_shipped():
    told = [row for row in ROWS if row[0] in ARMS and len(row) == 7]
    found = [(name, each) for name in ARMS for each in model(name).capsules]
    assert [row[:2] for row in told] == [[name, each.part] for name, each in found]
    for row, (_, each) in zip(told, found, strict=True):
        length = float(np.linalg.norm(each.b - each.a))
        assert [float(row[2]), float(row[3])] == pytest.approx([1e3 * each.radius, 1e3 * length], abs=0.06)


def test_the_limits_are_those_of_the_models():
    by_name = {row[0]: row[1:] for row in ROWS}
    arms = [model(name) for name in ARMS]
    assert by_name["joints"] == [str(arm.n) for arm in arms]
    assert by_name["capsules, pairs kept apart"] == [f"{len(a.capsules)}, {len(a.self_pairs)}" for a in arms]
    for words, key in (("velocity (rad/s)", "max_velocity"), ("torque (N m)", "max_torque")):
        assert by_name[words] == [", ".join(f"{x:g}" for x in getattr(arm, key)) for arm in arms]
    assert by_name["acceleration (rad/s²)"] == [", ".join(f"{x:g}" for x in a.max_acceleration) for a in arms]
