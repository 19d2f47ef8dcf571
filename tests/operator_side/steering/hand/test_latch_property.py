"""The latch: armed exactly while one press is held without a gap, whatever else is said and however late."""

import itertools

from hypothesis import given
from hypothesis import strategies as st

from farhand.operator_side.steering.hand.latch import SILENCE_NS, Latch

MS = 1_000_000
messages = st.lists(
    st.tuples(st.integers(1, 200), st.booleans(), st.integers(0, 1)), max_size=30
)  # ms since the one before, engaged, presses since then


def held(story, now):
    """Whether the newest press was held from a message on up to now, each within the silence of the next."""
    if not story:
        return False
    press = story[-1][2]
    since = next(k for k, (_, _, p) in enumerate(story) if p == press)
    if press <= max((p for _, _, p in story[:since]), default=0):
        return False
    instants = [t for t, _, _ in story[since:]] + [now]
    gaps = [b - a for a, b in itertools.pairwise(instants)]
    began = next((k for k, (_, engaged, _) in enumerate(story[since:]) if engaged), None)
    # A press that comes with its release already is over; nothing of it arms later.
    return began == 0 and all(engaged for _, engaged, _ in story[since:]) and max(gaps) <= SILENCE_NS


@given(messages, st.integers(0, 400))
def test_armed_exactly_while_one_press_is_held(said, later):
    latch, story, now, press = Latch(), [], 0, 0
    for gap, engaged, presses in said:
        now += gap * MS
        press += presses
        assert latch.holds(now) is held(story, now)
        latch.hear(engaged, press, now)
        story.append((now, engaged, press))
        assert latch.holds(now) is held(story, now)
    assert latch.holds(now + later * MS) is held(story, now + later * MS)


@given(st.integers(1, 9), st.integers(SILENCE_NS + 1, 10 * SILENCE_NS))
def test_who_wakes_with_the_key_still_down_moves_nothing(press, asleep):
    latch = Latch()
    latch.hear(True, press, 0)
    assert latch.holds(SILENCE_NS)
    for k in range(5):
        latch.hear(True, press, asleep + k * 20 * MS)
        assert not latch.holds(asleep + k * 20 * MS)
    latch.hear(True, press + 1, asleep + 100 * MS)
    assert latch.holds(asleep + 100 * MS)


def test_disarmed_from_outside_it_wants_a_new_press():
    latch = Latch()
    latch.hear(True, 1, 0)
    latch.disarm()
    latch.hear(True, 1, MS)
    assert not latch.holds(MS)
    latch.hear(True, 2, 2 * MS)
    assert latch.holds(2 * MS)
