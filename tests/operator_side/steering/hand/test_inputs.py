"""Names with signs, dead zone and curve; and the settings that are made of them."""

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from farhand.operator_side.steering.hand.gamepad import GamepadSettings
from farhand.operator_side.steering.hand.inputs import read_inputs, shaped
from farhand.operator_side.steering.hand.spacemouse import SpacemouseSettings

values, zones, curves = st.floats(-1, 1), st.floats(0, 0.9), st.floats(0, 1)


@given(values, values, zones, curves)
def test_a_curve_is_odd_rises_and_keeps_centre_and_end(a, b, zone, expo):
    low, high = sorted((a, b))
    assert shaped(low, zone, expo) <= shaped(high, zone, expo) + 1e-12
    assert shaped(-a, zone, expo) == -shaped(a, zone, expo)
    assert shaped(1.0, zone, expo) == pytest.approx(1.0)
    assert shaped(zone * a, zone, expo) == 0.0


def test_signs_add_up_to_one_at_most():
    inputs = read_inputs("+righttrigger -lefttrigger  lefty")
    assert inputs.names == ("righttrigger", "lefttrigger", "lefty")
    assert inputs.value({"righttrigger": 0.5, "lefttrigger": 0.25, "lefty": 0.0}.__getitem__) == 0.25
    assert inputs.value({"righttrigger": 1.0, "lefttrigger": 0.0, "lefty": 1.0}.__getitem__) == 1.0
    assert read_inputs("").value(lambda name: 1.0) == 0.0


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ({"x": "leftz"}, "x: no such input: 'leftz'; there are leftx"),
        ({"x": "--lefty"}, "'--lefty' is no input"),
        ({"deadman": " "}, "deadman: must name a button"),
        ({"deadman": "cap"}, "no such input: 'cap'"),
        ({"scales": [1.0, 0.5]}, "scales: must rise"),
        ({"scales": []}, "length"),
        ({"dead_zone": 1.0}, "< 1.0"),
        ({"frame": "view"}, "view"),
        ({"sped": 1.0}, "sped"),
    ],
)
def test_what_cannot_be_is_refused_in_words(table, words):
    with pytest.raises(msgspec.ValidationError, match=words):
        msgspec.convert(table, GamepadSettings)


def test_raw_names_and_the_cap():
    assert GamepadSettings(x="-axis1", deadman="button5 button4").inputs("deadman").names == (
        "button5",
        "button4",
    )
    assert SpacemouseSettings(deadman="cap").held_by_cap
    assert not SpacemouseSettings().held_by_cap
