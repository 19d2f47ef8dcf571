"""What happened, in words: one command is one, and two are two."""

import msgspec

from farhand.foxglove.happenings import Happenings
from farhand.testing import state


def test_refused_commands_are_counted_in_words():
    seen = Happenings()
    words = []
    for number in (0, 1, 3):
        told = msgspec.structs.replace(state(), refused={"stale": number})
        words += [each.words for each in seen.state(told, number)]
    assert words == [
        "the robot refused 1 command (so far: stale 1)",
        "the robot refused 2 commands (so far: stale 3)",
    ]
