"""A camera that was there and shows nothing new is frozen; one that never was, or is gone for good, is not."""

import pytest

from farhand.operator_side.console.sight import GONE_AFTER, Sight

MS = 1_000_000


@pytest.mark.parametrize(
    ("between_ms", "silent_ms", "frozen"),
    [(50, 900, 0.0), (50, 1100, 1.1), (1000, 2400, 0.0), (1000, 2600, 2.6), (50, GONE_AFTER * 1000, 0.0)],
)
def test_frozen_is_what_is_silent_for_longer_than_it_is_slow(between_ms, silent_ms, frozen):
    sight = Sight()
    assert sight.frozen(10**12) == 0.0
    sight.note(5 * MS)
    sight.note((5 + between_ms) * MS)
    assert sight.frozen(round((5 + between_ms + silent_ms) * MS)) == pytest.approx(frozen)
