"""The committed step to the side: when it begins, how it turns, when it is over."""

import math

import pytest

from farhand.operator_side.steering.sides import MOST, STEP
from farhand.operator_side.steering.tester.sidestep import LONGEST_NS, Instant, Progress, Sidestep

TICK_NS = 100_000_000
AHEAD = (0.3, 0.0, 0.0)
STILL = (0.0, 0.0, 0.0)


class Rider:
    """A sidestep, read once a tick; by how much it turns to the left of x (rad)."""

    def __init__(self):
        self.sidestep, self.now, self.closed = Sidestep(), 0, 1.0

    def free(self, velocities):
        """Free is what points `closed` rad or more to either side in the plane."""
        return [abs(math.atan2(v[1], v[0])) > self.closed - 1e-9 and abs(v[2]) < 1e-9 for v in velocities]

    def turn(self, position=STILL, velocity=STILL, wanted=AHEAD):
        turned = self.sidestep.turn(wanted, Instant(self.now, position, velocity, self.free))
        self.now += TICK_NS
        return math.atan2(turned[1], turned[0])

    def begin(self):
        """Until it has committed itself."""
        angles = [self.turn() for _ in range(7)]
        assert angles[:6] == [0.0] * 6
        return angles[6]


def test_it_begins_after_six_tenths_without_progress_where_the_way_is_not_free():
    rider = Rider()
    assert rider.begin() == pytest.approx(1.0)
    assert rider.sidestep.side == "left"


def test_a_wish_too_small_to_point_anywhere_is_none():
    progress = Progress()
    assert not any(
        progress.lacking((1e-170, 0.0, 0.0), (-0.1, 0.0, 0.0), k * 1_000_000_000) for k in range(3)
    )


def test_it_does_not_begin_while_the_robot_moves_or_the_way_is_free():
    rider = Rider()
    assert [rider.turn(velocity=(0.1, 0.0, 0.0)) for _ in range(20)] == [0.0] * 20
    rider.closed = 0.0
    assert [rider.turn() for _ in range(20)] == [0.0] * 20
    assert rider.sidestep.side == ""


def test_the_angle_follows_what_is_free_and_the_side_is_kept():
    rider = Rider()
    rider.begin()
    across = (0.0, 0.3, 0.0)
    rider.closed = 0.5
    assert rider.turn(velocity=across) == pytest.approx(0.5)
    rider.closed = 1.2
    assert rider.turn(velocity=across) == pytest.approx(1.2)
    assert rider.sidestep.side == "left"


def test_it_turns_on_where_the_robot_stands_all_the_same():
    rider = Rider()
    first = rider.begin()
    angles = [rider.turn() for _ in range(10)]
    assert angles[-1] > first + 3 * STEP


def test_it_is_over_past_its_start_or_when_the_wish_turns_round():
    for end in ({"position": (0.06, 0.0, 0.0)}, {"wanted": (-0.3, 0.0, 0.0)}):
        rider = Rider()
        rider.begin()
        rider.turn(velocity=(0.0, 0.3, 0.0))
        rider.turn(**end)
        assert rider.sidestep.side == ""
    rider = Rider()
    rider.begin()
    rider.turn(wanted=STILL)
    assert rider.sidestep.side == ""


def test_after_fifteen_seconds_the_other_side_is_tried():
    rider = Rider()
    rider.begin()
    for _ in range(LONGEST_NS // TICK_NS + 1):
        rider.turn(velocity=(0.0, 0.3, 0.0))
    assert rider.sidestep.side == "right"


def test_where_nothing_is_free_it_goes_straight_on_or_as_far_round_as_it_may():
    rider = Rider()
    rider.closed = 9.0
    assert [rider.turn() for _ in range(20)] == [0.0] * 20
    rider = Rider()
    rider.begin()
    rider.closed = 9.0
    assert rider.turn(velocity=(0.0, 0.3, 0.0)) == pytest.approx(MOST - 2 * math.pi)
