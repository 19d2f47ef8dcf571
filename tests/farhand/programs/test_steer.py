"""What the main thread of `farhand steer` does: read, say, shake; and what it refuses."""

import pytest

from farhand.cli import run
from farhand.common.timing.clock import SystemClock
from farhand.operator_side.devices.device_node import DeviceNode
from farhand.operator_side.devices.hand import Hand
from farhand.operator_side.steering.hand.gamepad import GamepadSettings
from farhand.operator_side.steering.hand.sender import SteeringSender
from farhand.programs.steer import RUMBLE_EVERY, reading
from farhand.testing import ScriptedLink


class Source:
    """Nothing is plugged in, and what may not be opened is said."""

    def __init__(self):
        self.shaken, self.trouble = [], ""

    def read(self, _now_ns):
        return None

    def rumble(self, strength):
        self.shaken.append(strength)


def test_it_shakes_by_what_is_not_done_and_says_each_thing_once():
    source, told, link = Source(), [], ScriptedLink("r")
    node = DeviceNode(
        Hand(GamepadSettings(), "gamepad"), link, SteeringSender("r", link, 1, "device", "gamepad")
    )
    work = reading(source, node, SystemClock(), 0.5, told.append)
    steps = iter([0.0] * RUMBLE_EVERY + [0.8] * 2 * RUMBLE_EVERY + [0.0] * 3 * RUMBLE_EVERY)

    def ends():
        node.strength = next(steps, None)
        node.says = "hold it"
        source.trouble = "may not be opened" if node.strength == 0.8 else ""
        return node.strength is None

    work(ends)
    assert source.shaken == [0.4, 0.4, 0.0]
    assert told == ["hold it", "may not be opened", "hold it"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["tester"], "no device of this host"),
        (["gamepd"], "is 'gamepad' meant?"),
        (["gamepad", "--connect", "tcp/10.0.0.1:7446"], "must be on this host"),
        (["gamepad", "--robot", "a/b"], "a robot's name"),
        (["gamepad", "--set", "steering.gamepad.x=leftz"], "no such input: 'leftz'"),
        (["gamepad", "--set", "steering.gamepad.deadman="], "must name a button"),
    ],
)
def test_what_cannot_be_is_one_line_and_code_2(arguments, words, capsys):
    assert run(["steer", *arguments]) == 2
    said = capsys.readouterr().err
    assert words in said
    assert said.count("\n") == 1
