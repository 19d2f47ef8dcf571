"""After an outage it is said how long there was no news, until somebody presses or for five seconds."""

import pytest

from farhand.operator_side.console.absence import SAID_FOR_NS, Absence

S = 1_000_000_000


def back_after_three():
    absence = Absence()
    for lost, at in ((True, 0), (False, 2 * S), (True, 4 * S), (False, 7 * S)):
        absence.note(lost, at, pressed=False)
    return absence


def test_it_is_said_for_a_while_or_until_a_press():
    absence = back_after_three()
    assert absence.was_lost == pytest.approx(3.0)
    absence.note(False, 7 * S + SAID_FOR_NS, pressed=False)
    assert absence.was_lost
    absence.note(False, 7 * S + SAID_FOR_NS + 1, pressed=False)
    assert not absence.was_lost
    absence = back_after_three()
    absence.note(False, 8 * S, pressed=True)
    absence.note(False, 8 * S, pressed=False)
    assert not absence.was_lost


def test_the_silence_before_it_was_noticed_counts():
    absence = Absence(unnoticed_ns=1 * S)
    for lost, at in ((False, 0), (True, 4 * S), (False, 4 * S + 1)):
        absence.note(lost, at, pressed=False)
    assert absence.was_lost == pytest.approx(1.0)


def test_the_first_news_is_no_return():
    absence = Absence()
    absence.note(True, 0, pressed=False)
    absence.note(False, 3 * S, pressed=False)
    assert not absence.was_lost


def test_a_stop_that_was_latched_meanwhile_keeps_it_until_it_is_acknowledged():
    absence = back_after_three()
    absence.note(False, 100 * S, pressed=False, stopped=True)
    assert absence.was_lost == pytest.approx(3.0)
    absence.note(False, 101 * S, pressed=False)
    assert absence.was_lost
    absence.note(False, 101 * S + SAID_FOR_NS, pressed=False)
    assert not absence.was_lost
