"""What keeps a UR arm from being driven: only one that runs, is in order, and answers, is ready."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from farhand.robot_side.ur.attention import Attention
from farhand.robot_side.ur.settings import UrSettings
from farhand.robot_side.ur.states import Facts, blocked, may_start, slowed, unready

GOOD = {
    "robot_mode": 7, "safety_mode": 1, "runtime_state": 2, "robot_status_bits": 3, "target_speed_fraction": 1.0,
    "timestamp": 0.0, "output_int_register_25": 11, "output_int_register_26": 0, "payload": 0.0,
}  # fmt: skip


def facts(age=0.0, answer_age=0.0, trouble="", remote=True, run=11, **values):
    return Facts(GOOD | values, age, trouble, remote, run, answer_age)


def test_one_that_runs_and_answers_is_ready():
    assert unready(facts()) == ""
    assert unready(facts(remote=None)) == ""


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"safety_mode": 3}, "protective stop"),
        ({"safety_mode": 7}, "emergency stop"),
        ({"safety_mode": 6}, "emergency stop"),
        ({"safety_mode": 5}, "safeguard stop"),
        ({"safety_mode": 9}, "safety fault"),
        ({"robot_mode": 6}, "freedrive"),
        ({"robot_status_bits": 7}, "freedrive"),
        ({"robot_mode": 3}, "power off"),
        ({"robot_mode": 5}, "brakes closed"),
        ({"remote": False}, "local mode"),
        ({"runtime_state": 4}, "paused"),
        ({"runtime_state": 1}, "does not run"),
        ({"runtime_state": 1, "output_int_register_26": 1}, "heard nothing in time"),
        ({"output_int_register_25": 12}, "another program"),
        ({"run": 0}, "another program"),
        ({"target_speed_fraction": 0.0}, "slider at 0"),
        ({"answer_age": 0.2}, "has been silent"),
        ({"age": 0.2}, "no state"),
        ({"trouble": "it hung up"}, "it hung up"),
    ],
)
def test_each_state_says_what_it_is(wrong, said):
    assert said in unready(facts(**wrong))


ANYTHING = st.builds(
    facts,
    age=st.sampled_from([0.0, 0.05, 0.2, 1e9]),
    answer_age=st.sampled_from([0.0, 0.3]),
    remote=st.sampled_from([None, True, False]),
    run=st.sampled_from([0, 11]),
    robot_mode=st.integers(-1, 8),
    safety_mode=st.integers(0, 12),
    runtime_state=st.integers(0, 5),
    robot_status_bits=st.integers(0, 15),
    target_speed_fraction=st.sampled_from([0.0, 0.1, 1.0]),
    output_int_register_25=st.sampled_from([0, 11, 12]),
)


@given(ANYTHING)
def test_whatever_the_controller_says_nothing_else_is_ready(known):
    values = known.values
    good = (
        values["robot_mode"] == 7
        and values["safety_mode"] in (1, 2)
        and not values["robot_status_bits"] & 4
        and known.remote is not False
        and known.age <= 0.1
    )
    assert (blocked(known) == "") == good
    assert may_start(known) == (good and values["runtime_state"] == 1)
    ours = values["runtime_state"] == 2 and known.run == values["output_int_register_25"] == 11
    driven = good and ours and values["target_speed_fraction"] > 0.0 and known.answer_age <= 0.1
    assert (unready(known) == "") == driven


def test_nothing_is_known_before_the_first_state():
    assert "no state" in unready(Facts({}, 1e9))


def test_speed_scaling_is_said_and_calls_for_attention_once():
    attention = Attention(UrSettings())
    assert "just started" in attention.calls(GOOD)
    assert attention.calls(GOOD) == ""
    half = GOOD | {"target_speed_fraction": 0.5}
    for at in (1.0, 1.1, 1.29, 1.31):
        assert "50%" in attention.calls(half | {"timestamp": at})  # until the scaling has followed the slider
    assert attention.calls(half | {"timestamp": 1.4}) == ""
    assert slowed(half) == "speed scaling 50%"
    assert "100%" in attention.calls(
        GOOD | {"timestamp": 2.0}
    )  # and up again: the same command is twice as fast


def test_a_slider_that_goes_on_moving_goes_on_calling():
    attention = Attention(UrSettings())
    attention.calls(GOOD)
    for step in range(1, 9):
        moved = GOOD | {"target_speed_fraction": 1.0 - 0.1 * step, "timestamp": 0.25 * step}
        assert attention.calls(moved)


def test_another_payload_calls_for_attention_and_a_wrong_one_does_not_cease_to():
    attention = Attention(UrSettings())
    assert "just started" in attention.calls(GOOD)
    assert attention.calls(GOOD) == ""
    assert "2 kg now, it had 0 kg" in attention.calls(GOOD | {"payload": 2.0})
    assert attention.calls(GOOD | {"payload": 2.0}) == ""
    wrong = Attention(UrSettings(payload=1.0))
    wrong.calls(GOOD)
    assert all("scenario 1 kg" in wrong.calls(GOOD) for _ in range(3))
    assert wrong.calls(GOOD | {"payload": 1.0}) == ""
