"""The wheel: one driver; free when given up, or after 2 s of silence."""

from farhand.operator_side.steering.hand.wheel import FREE_AFTER_NS, Wheel


def test_the_first_who_wants_it_keeps_it_from_others():
    wheel = Wheel()
    assert not wheel.ask(1, "console", 0, wants=False)
    assert wheel.ask(1, "console", 1, wants=True)
    assert not wheel.ask(2, "gamepad", 2, wants=True)
    assert (wheel.driver, wheel.name) == (1, "console")


def test_silence_frees_it_and_words_keep_it():
    wheel = Wheel()
    wheel.ask(1, "console", 0, wants=True)
    wheel.ask(1, "console", FREE_AFTER_NS, wants=False)
    assert wheel.look(2 * FREE_AFTER_NS) == 1
    assert wheel.look(2 * FREE_AFTER_NS + 1) == 0
    assert wheel.ask(2, "gamepad", 2 * FREE_AFTER_NS + 2, wants=True)
