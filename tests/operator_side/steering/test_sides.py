"""Turning a wish to a side, and the way round with the smallest turn."""

import math

import pytest

from farhand.common.geometry import norm
from farhand.operator_side.steering.sides import (
    ANGLES,
    SIDES,
    WayRound,
    fan,
    towards,
    turned_towards,
    way_round,
)

AHEAD = (0.3, 0.0, 0.0)


def free_beyond(limits):
    """Free is what points more than so many rad to a side; a side that is not there is never free."""

    def verdict(velocity):
        for side, limit in limits.items():
            across = towards(AHEAD, side)
            part = sum(a * v for a, v in zip(across, velocity, strict=True))
            if math.atan2(part, velocity[0]) > limit - 1e-9:
                return True
        return False

    return lambda velocities: [verdict(velocity) for velocity in velocities]


def test_sides_are_those_of_who_looks_along_the_way():
    assert towards(AHEAD, "left") == pytest.approx((0.0, 1.0, 0.0))
    assert towards(AHEAD, "right") == pytest.approx((0.0, -1.0, 0.0))
    assert towards(AHEAD, "above") == pytest.approx((0.0, 0.0, 1.0))
    assert towards((0.0, -2.0, 0.0), "left") == pytest.approx((1.0, 0.0, 0.0))
    assert towards((0.0, 0.0, -1.0), "above") == pytest.approx((1.0, 0.0, 0.0))


@pytest.mark.parametrize("side", SIDES)
def test_a_turned_wish_is_as_fast_and_turned_by_that_angle(side):
    wish = (0.1, -0.2, 0.25)
    turned = turned_towards(wish, towards(wish, side), 0.7)
    assert norm(turned) == pytest.approx(norm(wish))
    cosine = sum(a * b for a, b in zip(wish, turned, strict=True)) / norm(wish) ** 2
    assert cosine == pytest.approx(math.cos(0.7))
    assert turned_towards(wish, wish, 0.7) == wish


@pytest.mark.parametrize("side", SIDES)
def test_a_fan_holds_every_turn(side):
    wish = (0.1, -0.2, 0.25)
    across = towards(wish, side)
    assert fan(wish, across).tolist() == [
        pytest.approx(turned_towards(wish, across, angle), abs=1e-15) for angle in ANGLES
    ]
    assert fan(wish, wish).tolist() == [list(wish)] * len(ANGLES)


def test_the_way_round_is_the_side_with_the_smallest_turn():
    assert way_round(AHEAD, free_beyond({"left": 1.0, "below": 0.6})) == WayRound("below", pytest.approx(0.6))
    assert way_round(AHEAD, free_beyond({"left": 0.6, "above": 0.6})).side == "left"
    assert way_round(AHEAD, free_beyond({})) is None
