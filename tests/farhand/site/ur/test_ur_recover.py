"""What brings a stopped UR arm back, step by step; and what a check says of a state."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from farhand.robot_side.ur.settings import UrSettings
from farhand.robot_side.ur.states import Facts
from farhand.site.ur.check import judge_state, limits_question
from farhand.site.ur.recover import next_step

GOOD = {
    "robot_mode": 7, "safety_mode": 1, "runtime_state": 1, "robot_status_bits": 1, "target_speed_fraction": 1.0,
    "output_int_register_25": 0, "payload": 0.0, "tcp_offset": [0.0] * 6,
}  # fmt: skip


def facts(remote=True, **values):
    return Facts(GOOD | values, 0.0, remote=remote)


@pytest.mark.parametrize(
    ("state", "kind", "command"),
    [
        ({}, "done", ""),
        ({"runtime_state": 2, "output_int_register_25": 7}, "done", ""),  # Farhand's own program
        ({"runtime_state": 2}, "wait", ""),
        ({"safety_mode": 3}, "do", "unlock protective stop"),
        ({"safety_mode": 5}, "wait", ""),
        ({"safety_mode": 7}, "wait", ""),
        ({"safety_mode": 9}, "wait", ""),
        ({"robot_mode": 6}, "wait", ""),
        ({"robot_status_bits": 5}, "wait", ""),
        ({"robot_mode": 3}, "do", "power on"),
        ({"robot_mode": 5}, "do", "brake release"),
        ({"robot_mode": 2}, "wait", ""),
        ({"runtime_state": 4}, "do", "stop"),
        ({"remote": False, "safety_mode": 3}, "wait", ""),
        ({"target_speed_fraction": 0.0}, "wait", ""),
    ],
)
def test_each_state_has_its_next_step(state, kind, command):
    step = next_step(facts(**state))
    assert (step.kind, step.command) == (kind, command)
    assert step.said


ANY = st.builds(
    facts,
    remote=st.sampled_from([None, True, False]),
    robot_mode=st.integers(-1, 8),
    safety_mode=st.integers(0, 12),
    runtime_state=st.integers(0, 5),
    robot_status_bits=st.integers(0, 15),
    target_speed_fraction=st.sampled_from([0.0, 1.0]),
    output_int_register_25=st.sampled_from([0, 7]),
)


@given(ANY)
def test_nothing_is_ever_played_and_a_stop_is_unlocked_only_after_a_question(known):
    step = next_step(known)
    assert step.command in ("", "stop", "power on", "brake release", "unlock protective stop")
    if step.command == "unlock protective stop":
        assert step.asks
        assert known.values["safety_mode"] == 3
    if step.kind == "done":
        assert known.values["robot_mode"] == 7
        assert known.values["safety_mode"] in (1, 2)
        assert known.remote is not False


@pytest.mark.parametrize(
    ("state", "level", "what", "said"),
    [
        ({}, "good", "state", "running"),
        ({"safety_mode": 2}, "note", "state", "reduced"),
        ({"safety_mode": 3}, "bad", "state", "protective stop"),
        ({"runtime_state": 2}, "bad", "program", "another program"),
        ({"target_speed_fraction": 0.4}, "note", "speed", "40%"),
        ({}, "good", "payload", "1 kg"),
        ({"payload": 3.0}, "bad", "payload", "3 kg, the scenario has 1 kg"),
    ],
)
def test_a_check_says_what_a_state_means(state, level, what, said):
    found = judge_state(facts(**state), UrSettings(payload=1.0))
    assert any((each.level, each.what) == (level, what) and said in each.found for each in found), found
    assert all(each.remedy for each in found if each.level != "good")


def test_the_question_for_limits_moves_nothing():
    from farhand.robot_side.arm.model import model

    text = limits_question(model("ur5"), [0.0] * 6)
    assert text.startswith("sec ")
    assert text.count("is_within_safety_limits") == 12
    assert not any(word in text for word in ("movej", "speedj", "servoj", "stopj"))
