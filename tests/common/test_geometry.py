"""Turns, checked against rotation matrices."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from farhand.common.geometry import norm, turn_between, turned

START = (1.0, 0.0, 0.0, 0.0)
part = st.floats(-2.0, 2.0)
turns = st.tuples(part, part, part)


def matrix(q):
    w, x, y, z = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def test_a_turn_is_right_handed_and_about_the_bases_axes():
    quarter = turned(START, (0.0, 0.0, math.pi / 2))
    assert matrix(quarter) @ (1.0, 0.0, 0.0) == pytest.approx((0.0, 1.0, 0.0))
    both = turned(quarter, (math.pi / 2, 0.0, 0.0))
    assert matrix(both) @ (1.0, 0.0, 0.0) == pytest.approx((0.0, 0.0, 1.0))
    assert turned(quarter, (0.0, 0.0, 0.0)) is quarter


@given(turns, turns)
def test_the_turn_between_two_orientations_leads_from_one_to_the_other(first, second):
    one, other = turned(START, first), turned(turned(START, second), first)
    between = turn_between(one, other)
    assert norm(between) <= math.pi + 1e-9
    assert matrix(turned(one, between)) == pytest.approx(matrix(other), abs=1e-9)
    assert norm(turned(one, between)) == pytest.approx(1.0)
