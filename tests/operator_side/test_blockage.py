"""Whoever steers is told what stands in the way and where it is free."""

from farhand.operator_side.sensing.blockage import Blockage, Blocked
from farhand.testing import state

TICK_NS = 100_000_000
AHEAD = (0.3, 0.0, 0.0)


def left_is_free(velocities):
    return [v[1] > 0.25 for v in velocities]


def nothing_is_free(velocities):
    return [False] * len(velocities)


def everything_is_free(velocities):
    return [True] * len(velocities)


def last(free, ticks=8, moves=0.0, obstacle="ball"):
    blockage, said = Blockage(), Blocked()
    for k in range(ticks):
        said = blockage.look(AHEAD, state(velocity=(moves, 0.0, 0.0)), free, lambda: obstacle, k * TICK_NS)
    return said


def test_the_obstacle_and_the_free_side_are_named():
    assert last(left_is_free) == Blocked("ball", "left")
    assert last(nothing_is_free) == Blocked("ball", "")


def test_nothing_is_said_of_who_moves_or_has_stood_for_a_moment_or_for_another_reason():
    assert last(left_is_free, moves=0.1) == Blocked()
    assert last(left_is_free, ticks=6) == Blocked()
    assert last(everything_is_free) == Blocked()
    assert last(left_is_free, obstacle="") == Blocked()
