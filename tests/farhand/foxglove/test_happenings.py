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


def test_a_robot_that_was_started_anew_counts_its_refusals_anew():
    seen = Happenings()
    for session, number in ((1, 5), (2, 0), (2, 2)):
        told = list(seen.state(msgspec.structs.replace(state(session=session), refused={"stale": number}), 0))
    assert told[0].facts == {"commands": "2", "reasons": "stale 2"}
