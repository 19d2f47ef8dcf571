"""The demo with a hand at a device: a fourth program, whose words are shown, and which ends with it."""

import pytest

from farhand.testing import Program, short_task

pytest.importorskip("pygame")
pytestmark = pytest.mark.realtime
NOBODYS = "steering.gamepad.name=a gamepad that nobody has"


@pytest.mark.long
def test_the_devices_program_is_started_says_what_it_waits_for_and_ends_with_the_demo(tmp_path):
    words = (
        "--scenario",
        short_task(tmp_path),
        "--steer",
        "gamepad",
        "--set",
        NOBODYS,
        "--out",
        tmp_path / "run",
    )
    with Program("demo", *words, "--json", "--network", "none") as demo:
        demo.wait_for("to see it:")
        demo.wait_for("gamepad: no gamepad named 'a gamepad that nobody has' is plugged in")
        assert demo.interrupt() == 1
    assert (tmp_path / "run" / "steer.log").read_text().startswith("gamepad:")
