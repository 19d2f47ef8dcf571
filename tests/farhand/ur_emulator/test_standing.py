"""For how long an arm moves on after a command: as it is now, and the first time that it stood."""

import pytest

from farhand.ur_emulator.faults import STANDS_FOR, Watch


def watched(moves):
    """What a Watch says after one look each 10 ms, from 10 ms after the command on."""
    watch = Watch(100.0)
    for k, each in enumerate(moves):
        watch.look(each, 100.0 + 0.01 * (k + 1))
    return watch


def test_a_moment_at_the_turn_is_no_standing():
    turn = [True] * 5 + [False] * 10 + [True] * 5
    assert watched(turn).first is None
    assert watched(turn).stands is None
    assert watched(turn + [False] * 3).stands == pytest.approx(0.21)


def test_it_is_remembered_when_it_first_stood_whatever_came_later():
    stood = [True] * 5 + [False] * (round(STANDS_FOR / 0.01) + 2)
    for later in ([], [True] * 50, [True] * 50 + [False] * 100):
        assert watched(stood + later).first == pytest.approx(0.06)
    assert watched([*stood, True]).stands is None
