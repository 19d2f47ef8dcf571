"""What `farhand robots` says of a robot: nothing that an old state said is told as so."""

import pytest

from farhand.site.robots import Seen, robot_row
from farhand.testing import state


def test_a_live_state_is_told():
    row = robot_row("r", {"robot"}, Seen(state(mode="run", reason="commanded"), 0.02))
    assert (row["there"], row["mode"], row["control"]) == ("yes", "run: commanded", "operator")
    assert row["state_age"] == 0.02


@pytest.mark.parametrize("age", [1.1, 11.0])
def test_an_old_state_is_told_as_old_and_nobody_as_in_control(age):
    row = robot_row("r", {"robot"}, Seen(state(mode="run"), age))
    assert row["mode"] == f"no state for {age:.1f} s (was run)"
    assert (row["control"], row["operator"], row["waiting"]) == ("?", "none seen", "")


def test_a_robot_without_a_word():
    assert robot_row("r", {"robot"}, None)["mode"] == "no state"
    assert robot_row("r", {"operator"}, None)["there"] == "no"


def test_two_of_one_name_are_told():
    row = robot_row("r", {"robot"}, Seen(state(mode="hold", reason="x"), 0.02, twins=True))
    assert row["there"] == "several"
    assert row["mode"] == "several robots have this name; hold: x"
