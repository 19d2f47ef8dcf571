"""MoveIt Servo's codes, each from what the operator's program reports, and always with words."""

import pytest

from farhand.bridges.ros2.outbound.status import diagnostics, servo_status
from farhand.common.messages.intervention import Intervention
from farhand.testing import report, state

AHEAD, SLOW, STILL = (0.2, 0.0, 0.0), (0.1, 0.0, 0.0), (0.0, 0.0, 0.0)
GUARDED = {
    "part": "forearm",
    "obstacle": "post",
    "distance": 0.02,
    "limit": 0.01,
    "asked": 0.2,
    "what": "slowed",
}


@pytest.mark.parametrize(
    ("fields", "age", "held", "code", "words"),
    [
        ({}, 0.0, None, -1, "no news from the robot"),
        ({"safety": "run"}, 1.5, None, -1, "nothing is heard of the operator's program"),
        ({"safety": "run", "state_age": 0.9}, 0.2, None, -1, "no news from the robot"),
        ({"safety": "estop", "safety_reason": "by hand"}, 0.0, None, -1, "estop: by hand"),
        ({"safety": "hold", "stop_reason": "device not engaged"}, 0.0, None, 0, "device not engaged"),
        ({"safety": "run", "desired": AHEAD, "filtered": AHEAD}, 0.0, None, 0, ""),
        ({"desired": AHEAD, "filtered": SLOW}, 0.0, None, 4, "slowed for post; free to the left"),
        ({"desired": AHEAD, "filtered": STILL}, 0.0, None, 5, "halted for post; free to the left"),
        (
            {"desired": AHEAD, "guard": Intervention(**GUARDED, done=0.1)},
            0.0,
            None,
            4,
            "guard slowed: forearm 20 mm",
        ),
        (
            {"desired": AHEAD, "guard": Intervention(**GUARDED, done=0.0)},
            0.0,
            None,
            5,
            "guard slowed: forearm 20 mm",
        ),
        ({"safety": "run", "desired": AHEAD}, 0.0, "joint limit: elbow", 6, "joint limit: elbow"),
    ],
)
def test_codes(fields, age, held, code, words):
    filtered = {"safety": "run", "intervening": True, "binding": "post", "free_side": "left"}
    fields = filtered | fields if "desired" in fields and "safety" not in fields else fields
    found, said = servo_status(report(**fields), age, state(held_by=held) if held else state())
    assert found == code
    assert words in said


def test_what_is_silent_is_stale_and_what_was_refused_is_a_warning():
    told = {
        name: (level, words)
        for name, level, words, _ in diagnostics(None, 0.0, None, {"/joy: late": 3}, "waits")
    }
    assert told["link"] == (3, "waiting for the operator's program")
    assert told["ros2"] == (1, "waits")
