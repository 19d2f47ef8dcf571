"""What the guard is said to have done: slowed only where speed is gone, as the two speeds beside it show."""

import pytest

from farhand.common.messages.intervention import deed


@pytest.mark.parametrize(
    ("asked", "done", "said"),
    [
        ((0.455, 0.0, 0.0), (0.455, 0.0, 0.0), None),
        ((0.455, 0.0, 0.0), (0.45498, 0.004, 0.0), "turned"),
        ((0.455, 0.0, 0.0), (0.453, 0.0, 0.0), "slowed"),
        ((0.455, 0.0, 0.0), (0.0, 0.0, 0.0), "slowed"),
        ((0.455, 0.0, 0.0), (0.1, 0.3, 0.0), "turned"),
    ],
)
def test_slowed_is_said_where_speed_is_gone(asked, done, said):
    assert deed(asked, done, moves=False) == said
